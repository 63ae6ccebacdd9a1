// BILIN: compression only, rate sensitivities up to 0.5 (docs/method.md).
#include "core/scene/laws/bilin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/reporter.hpp"
#include "core/base/toml_reader.hpp"
#include "core/scene/expected_flow.hpp"
#include "core/scene/laws/crown_law.hpp"

namespace tomodem {
namespace {

/// Equilibrium error over rate t0 where chi sets the natural period: up to 0.68 was measured (phase B at s = 50, 2,000
/// particles), and over the strain in a step on the plateau: 36 to 51 (phase A, 5,000 and 50,000; docs/method.md).
constexpr double error_per_rate_and_period = 0.7;
constexpr double error_per_strain_step = 60;

constexpr const char* error_key = "max_equilibrium_error";

/// Points within the rates at which the master curve is compared with K rate^M.
constexpr int points = 40;

/// Largest |g(chi r) / g(chi) r^-M - 1|, r from `lowest` to 1.
double misfit(const law::BilinFlow& curve, double chi, double sensitivity, double lowest) {
    double largest = 0;
    for (int k = 0; k <= points; ++k) {
        const double ratio = std::pow(lowest, static_cast<double>(k) / points);
        largest =
            std::max(largest, std::abs(curve.at(chi * ratio) / curve.at(chi) * std::pow(ratio, -sensitivity) - 1));
    }
    return largest;
}

/// Below its table the curve is taken as constant: what it loses there if it falls on as steeply as it began.
double fall_below(const law::BilinFlow& curve, double chi) {
    if (chi >= curve.chi[0]) return 0;
    const double slope = std::log(curve.flow[1] / curve.flow[0]) / std::log(curve.chi[1] / curve.chi[0]);
    return 1 - std::pow(chi / curve.chi[0], std::max(0.0, slope));
}

const BilinCalibration& table_of(const Scene& scene) {
    return *scene.flow_table().find<BilinCalibration>();
}

class Bilin final : public CrownLaw {
 public:
    Bilin() : CrownLaw({.name = "bilin", .min_steps_per_period = law::min_steps_per_period}, 10.0) {}

    void read_phase(TomlReader& reader, Phase& phase) const override {
        CrownLaw::read_phase(reader, phase);
        reader.refuse("greatest_attraction", "greatest_attraction belongs to law \"trilin\"");
    }

    void read_accuracy(TomlReader& reader, Scene& scene) const override {
        CrownLaw::read_accuracy(reader, scene);
        reader.refuse("equilibrium_error",
                      fmt::format("equilibrium_error is called {} now: the largest value of that curve", error_key));
        const auto bound = reader.optional_positive(error_key);
        if (!bound) return;
        if (scene.time_step || reader.find("strain_per_step") != nullptr)
            reader.fail(reader.get(error_key),
                        fmt::format("{} chooses the time step: remove time_step and strain_per_step", error_key));
        scene.law_accuracy[error_key] = *bound;
    }

    std::shared_ptr<const CalibrationWindow> read_calibration(TomlReader& reader) const override {
        BilinCalibration found;
        found.curve.chi = reader.rising("chi");
        if (found.curve.chi.size() < 2)
            reader.fail(reader.get("chi"), "chi of the master curve needs two values or more");
        found.curve.flow = reader.list("flow", found.curve.chi.size());
        if (*std::min_element(found.curve.flow.begin(), found.curve.flow.end()) <= 0)
            reader.fail(reader.get("flow"), "flow of the master curve must be above 0");
        found.spread = reader.list("spread", found.curve.chi.size());
        found.curve.max_sensitivity = reader.number("greatest_sensitivity");
        found.strain_per_step = reader.range("strain_per_step");
        found.time_step_error = reader.list("time_step_error", found.curve.chi.size());
        read_window(reader, found, true);
        return std::make_shared<const BilinCalibration>(std::move(found));
    }

    const CalibrationWindow& expect(const Scene& scene, const Phase& wanted, const PhaseModel& phase,
                                    const Model& model, ExpectedFlow& found) const override {
        const BilinCalibration& table = table_of(scene);
        const double highest = scene.highest_rate(), strain_per_step = highest * model.time_step;
        const double sensitivity = wanted.norton->rate_sensitivity;
        found.rate = {highest / 10, highest};
        found.packings = 2 * table.spread_at(phase.chi);
        found.rates = misfit(table.curve, phase.chi, sensitivity, 0.1) + fall_below(table.curve, phase.chi);
        found.time_step = table.time_step_error_at(phase.chi);
        if (below(scene.lowest_rate(), found.rate[0]))
            found.outside.push_back(
                fmt::format("the rate falls to {:g} /s: constants for {:g} to {:g} /s, there up to {:.0f} % off",
                            scene.lowest_rate(), found.rate[0], found.rate[1],
                            100 * misfit(table.curve, phase.chi, sensitivity, scene.lowest_rate() / highest)));
        if (below(table.strain_per_step[1], strain_per_step))
            found.outside.push_back(fmt::format("a strain of {:g} in a time step, measured with {:g} to {:g}",
                                                strain_per_step, table.strain_per_step[0], table.strain_per_step[1]));
        return table;
    }

    void warn(const Scene& scene, const Model& model, Reporter& reporter) const override {
        CrownLaw::warn(scene, model, reporter);
        double error = error_per_strain_step * scene.highest_rate() * model.time_step;
        for (const PhaseModel& phase : model.phases)
            error = std::max(error, error_per_rate_and_period * scene.highest_rate() * phase.natural_period);
        if (error > large_equilibrium_error)
            reporter.warn(
                fmt::format("inertia may carry {:.0f} % of the load at {:g} /s (equilibrium_error): take a lower rate, "
                            "or max_equilibrium_error = {:g} in [accuracy]",
                            100 * error, scene.highest_rate(), large_equilibrium_error / 10));
    }

    std::string time_step_reason(const Scene& scene, const Model& model) const override {
        if (const auto bound = number_of(scene.law_accuracy, error_key))
            return fmt::format("{} {:g}", error_key, *bound);
        return Law::time_step_reason(scene, model);
    }

 protected:
    /// The flow stress K rate^M at the highest rate, and the chi of that M; on the rate-insensitive plateau the natural
    /// period is the shortest stable one.
    Constants constants_for(const Scene& scene, const Norton& flow, double time_step) const override {
        const law::BilinFlow& curve = table_of(scene).curve;
        const double rate = scene.highest_rate(), chi = curve.chi_for(flow.rate_sensitivity);
        const double period = std::max(law::min_steps_per_period * time_step, std::sqrt(chi * time_step / rate));
        const double stress = flow.stress(rate) * pascal_per_megapascal;
        return {stress * 2 * scene.seed_radius / curve.at(rate * period * period / time_step), period};
    }

    /// The longest whose inertia keeps within the bound on the equilibrium error, where the scene has one.
    double strain_per_step(const Scene& scene) const override {
        const auto bound = number_of(scene.law_accuracy, error_key);
        if (!bound) return scene.step_strain();
        const double longest = *bound / error_per_rate_and_period;  // rate t0
        double strain_per_step = longest / law::min_steps_per_period;
        for (const Phase& phase : scene.phases) {
            if (phase.norton) {
                // chi = (rate t0)^2 / strain_per_step
                const double chi = table_of(scene).curve.chi_for(phase.norton->rate_sensitivity);
                const double most = chi > 0 ? longest * longest / chi : *bound / error_per_strain_step;
                strain_per_step = std::min(strain_per_step, most);
            } else if (const double error = error_per_rate_and_period * scene.highest_rate() * *phase.natural_period;
                       error > *bound) {
                throw InvalidInput(fmt::format(
                    "scene '{}' line {}: the natural period {:g} s of [phase.{}] alone may make an equilibrium error "
                    "of {:.2g}, above the {:g} asked for; give a shorter one",
                    scene.path.string(), phase.line, *phase.natural_period, phase.name, error, *bound));
            }
        }
        return strain_per_step;
    }

    void check_rate(const Scene& scene, const Phase& phase, double period, double time_step) const override {
        const double rate = scene.highest_rate();
        if (const double chi = rate * period * period / time_step; chi > law::max_chi)
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] at {:g} /s has rate natural_period^2 / time_step = {:.3g}; above {:g} "
                "the packing collapses; take a lower rate or a shorter natural_period",
                scene.path.string(), phase.line, phase.name, rate, chi, law::max_chi));
    }
};

}  // namespace

double BilinCalibration::spread_at(double chi) const {
    return interpolated_in_logarithm(curve.chi, spread, chi);
}

double BilinCalibration::time_step_error_at(double chi) const {
    return interpolated_in_logarithm(curve.chi, time_step_error, chi);
}

const Law& bilin_law() {
    static const Bilin law;
    return law;
}

}  // namespace tomodem
