// TRILIN: compression and tension, one rate sensitivity of about 0.07 (docs/method.md).
#include "core/scene/laws/trilin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/toml_reader.hpp"
#include "core/base/units.hpp"
#include "core/scene/expected_flow.hpp"
#include "core/scene/laws/bilin.hpp"
#include "core/scene/laws/crown_law.hpp"

namespace tomodem {
namespace {

constexpr const char* attraction_key = "greatest_attraction";

const TrilinCalibration& table_of(const Scene& scene) {
    return *scene.flow_table().find<TrilinCalibration>();
}

class Trilin final : public CrownLaw {
 public:
    Trilin()
        : CrownLaw({.name = "trilin",
                    .feature = "bounded_attraction",
                    .crown_over_seed = law::trilin_crown_over_seed,
                    .strain_per_step = 1e-4,
                    .min_steps_per_period = law::trilin_steps_per_period,
                    .carries_tension = true,
                    .planes_pull = true,
                    .neighbour_skin = 1.6,
                    .list_skin = 0.15,
                    .packing_density = 0.74},
                   law::trilin_stiffness_ratio) {}

    void read_phase(TomlReader& reader, Phase& phase) const override {
        CrownLaw::read_phase(reader, phase);
        const auto attraction = reader.optional_positive(attraction_key, units::force);
        if (!attraction) return;
        if (phase.norton)
            reader.fail(reader.get(attraction_key),
                        fmt::format("{} follows from norton: remove one of the two", attraction_key));
        phase.law_numbers[attraction_key] = *attraction;
    }

    void read_accuracy(TomlReader& reader, Scene& scene) const override {
        CrownLaw::read_accuracy(reader, scene);
        for (const char* key : {"max_equilibrium_error", "equilibrium_error"})
            reader.refuse(key,
                          fmt::format("{} is not known beforehand for law \"trilin\"; choose strain_per_step", key));
    }

    std::shared_ptr<const CalibrationWindow> read_calibration(TomlReader& reader) const override {
        TrilinCalibration found;
        found.flow = {reader.positive("flow"), reader.number("sensitivity", -1), reader.number("tolerance")};
        found.rate = reader.range("rate");
        found.error = read_errors(reader);
        read_window(reader, found, true);
        return std::make_shared<const TrilinCalibration>(std::move(found));
    }

    const CalibrationWindow& expect(const Scene& scene, const Phase& wanted, const PhaseModel& phase, const Model&,
                                    ExpectedFlow& found) const override {
        const TrilinCalibration& table = table_of(scene);
        const double highest = scene.highest_rate();
        // t0 follows the highest rate; rates down to where the table began.
        found.rate = {table.rate[0] / phase.natural_period, table.rate[1] / phase.natural_period};
        found.packings = error_of(table.error, loads_of(scene), found);
        const double apart = std::abs(wanted.norton->rate_sensitivity - table.flow.sensitivity);
        found.rates = std::pow(highest / std::min(highest, scene.lowest_rate()), apart) - 1;
        for (double rate : {scene.lowest_rate(), highest})
            if (below(rate, found.rate[0]) || below(found.rate[1], rate)) {
                found.outside.push_back(fmt::format("rate times period is {:.2g}, measured at {:g} to {:g}",
                                                    rate * phase.natural_period, table.rate[0], table.rate[1]));
                break;
            }
        return table;
    }

 protected:
    /// The calibrated constants, at ten steps a natural period.
    Constants constants_for(const Scene& scene, const Norton& wanted, double time_step) const override {
        const law::TrilinFlow& flow = table_of(scene).flow;
        if (std::abs(wanted.rate_sensitivity - flow.sensitivity) > flow.tolerance) {
            const auto* const bilin = scene.flow_table().find<BilinCalibration>();
            const bool reached = bilin != nullptr && wanted.rate_sensitivity <= bilin->curve.max_sensitivity;
            throw InvalidInput(
                fmt::format("M = {:g} is out of reach of law \"trilin\", whose rate sensitivity is {:g} within {:g}; "
                            "{}",
                            wanted.rate_sensitivity, flow.sensitivity, flow.tolerance,
                            reached ? "under compression law \"bilin\" can, in tension too law \"norton\""
                                    : "law \"norton\" can, for any M up to 1"));
        }
        const double rate = scene.highest_rate(), period = law::trilin_steps_per_period * time_step;
        const double stress = wanted.stress(rate) * pascal_per_megapascal;
        return {stress * 2 * scene.seed_radius / flow.at(rate * period), period};
    }

    void check_rate(const Scene& scene, const Phase& phase, double period, double) const override {
        const double rate = scene.highest_rate();
        if (rate * period > law::trilin_max_rate)
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] at {:g} /s has rate natural_period = {:.3g}; above {:g} the planes "
                "outrun the packing; take a lower rate or a shorter natural_period",
                scene.path.string(), phase.line, phase.name, rate, rate * period, law::trilin_max_rate));
    }

    double max_attraction(const Scene& scene, const Phase& phase, double stiffness) const override {
        return number_of(phase.law_numbers, attraction_key)
            .value_or(law::trilin_attraction * stiffness * scene.seed_radius);
    }
};

}  // namespace

const Law& trilin_law() {
    static const Trilin law;
    return law;
}

}  // namespace tomodem
