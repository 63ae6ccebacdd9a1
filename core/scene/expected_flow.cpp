#include "core/scene/expected_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

constexpr double pascal_per_megapascal = 1e6;

/// A number that was computed is outside of a range only if it is so by more than rounding.
bool below(double value, double limit) {
    return value < limit * (1 - 1e-6);
}

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

/// Largest |strain| in each direction; none: the scene has no load in it.
struct Loads {
    std::optional<double> compression, tension;
};

Loads loads_of(const Scene& scene) {
    Loads found;
    double reached = 0;
    for (const LoadStep& step : scene.steps) {
        std::optional<double>& largest = step.strain < reached ? found.compression : found.tension;
        // Pulled back from a compression: what counts is how far the material has been.
        largest = std::max({largest.value_or(0), std::abs(step.strain), std::abs(reached)});
        reached = step.strain;
    }
    return found;
}

double error_of(const DirectedErrors& table, const Loads& loads, ExpectedFlow& found) {
    double largest = 0;
    for (const auto& [asked, error, name] :
         {std::tuple(loads.compression.has_value(), table.compression, "compression"),
          std::tuple(loads.tension.has_value(), table.tension, "tension")}) {
        if (!asked) continue;
        if (!error) found.outside.push_back(fmt::format("{} was not measured", name));
        largest = std::max(largest, error.value_or(0));
    }
    return largest;
}

void check_sample(const CalibrationWindow& window, const Scene& scene, const Phase& phase, std::int64_t particles,
                  ExpectedFlow& found) {
    const auto count = static_cast<double>(particles);
    found.size = std::abs(window.size_error(count));
    const auto add = [&](std::string text) { found.outside.push_back(std::move(text)); };
    if (below(count, window.particles.front()) || below(window.particles.back(), count))
        add(fmt::format("{:.0f} particles, measured with {:g} to {:g}", count, window.particles.front(),
                        window.particles.back()));
    const double crown = scene.crown_radius / scene.seed_radius;
    if (window.crown && std::abs(crown / *window.crown - 1) > 1e-6)
        add(fmt::format("a crown of {:g} seed radii, measured with {:g}", crown, *window.crown));
    if (window.stiffness_ratio && std::abs(phase.stiffness_ratio / *window.stiffness_ratio - 1) > 1e-6)
        add(fmt::format("stiffness_ratio {:g}, measured with {:g}", phase.stiffness_ratio, *window.stiffness_ratio));
    const Loads loads = loads_of(scene);
    // A sample that is pressed a little before it is pulled has seen enough strain all the same.
    const double path = std::max(loads.compression.value_or(0), loads.tension.value_or(0));
    for (const auto& [largest, strain] : {std::pair(loads.compression, window.strain),
                                          std::pair(loads.tension, window.strain_tension.value_or(window.strain))}) {
        if (!largest) continue;
        found.strain = {std::max(found.strain[0], strain[0]),
                        found.strain[1] > 0 ? std::min(found.strain[1], strain[1]) : strain[1]};
        if (below(path, strain[0]))
            add(fmt::format("strain {:g}: the stress has risen to K rate^M at {:g} only", *largest, strain[0]));
        if (below(strain[1], *largest))
            add(fmt::format("strain {:g}: the stress is within {:g} % of the flow stress up to {:g}", *largest,
                            100 * window.strain_error, strain[1]));
    }
}

void look_at_bilin(const BilinCalibration& table, const Scene& scene, const Norton& wanted, const PhaseModel& phase,
                   double time_step, ExpectedFlow& found) {
    const double highest = scene.highest_rate(), strain_per_step = highest * time_step;
    found.rate = {highest / 10, highest};
    found.packings = 2 * table.spread_at(phase.chi);
    found.rates = misfit(table.curve, phase.chi, wanted.rate_sensitivity, 0.1) + fall_below(table.curve, phase.chi);
    found.time_step = table.time_step_error_at(phase.chi);
    if (below(scene.lowest_rate(), found.rate[0]))
        found.outside.push_back(
            fmt::format("the rate falls to {:g} /s: constants for {:g} to {:g} /s, there up to {:.0f} % off",
                        scene.lowest_rate(), found.rate[0], found.rate[1],
                        100 * misfit(table.curve, phase.chi, wanted.rate_sensitivity, scene.lowest_rate() / highest)));
    if (below(table.strain_per_step[1], strain_per_step))
        found.outside.push_back(fmt::format("a strain of {:g} in a time step, measured with {:g} to {:g}",
                                            strain_per_step, table.strain_per_step[0], table.strain_per_step[1]));
}

void look_at_trilin(const TrilinCalibration& table, const Scene& scene, const Norton& wanted, const PhaseModel& phase,
                    ExpectedFlow& found) {
    const double highest = scene.highest_rate();
    // t0 follows the highest rate; rates down to where the table began.
    found.rate = {table.rate[0] / phase.natural_period, table.rate[1] / phase.natural_period};
    found.packings = error_of(table.error, loads_of(scene), found);
    const double apart = std::abs(wanted.rate_sensitivity - table.flow.sensitivity);
    found.rates = std::pow(highest / std::min(highest, scene.lowest_rate()), apart) - 1;
    for (double rate : {scene.lowest_rate(), highest})
        if (below(rate, found.rate[0]) || below(found.rate[1], rate)) {
            found.outside.push_back(fmt::format("rate times period is {:.2g}, measured at {:g} to {:g}",
                                                rate * phase.natural_period, table.rate[0], table.rate[1]));
            break;
        }
}

void look_at_norton(const NortonCalibration& table, const Scene& scene, const Norton& wanted, ExpectedFlow& found) {
    const double highest = scene.highest_rate();
    found.rate = {highest / table.rate_ratio, highest};
    found.packings = error_of(table.error, loads_of(scene), found);
    if (below(scene.lowest_rate(), found.rate[0]))
        found.outside.push_back(
            fmt::format("the rate falls to {:g} /s, measured from {:g} to {:g} /s of the same constants",
                        scene.lowest_rate(), found.rate[0], found.rate[1]));
    if (below(wanted.rate_sensitivity, table.sensitivity[0]) || below(table.sensitivity[1], wanted.rate_sensitivity))
        found.outside.push_back(fmt::format("M = {:g}, measured with {:g} to {:g}", wanted.rate_sensitivity,
                                            table.sensitivity[0], table.sensitivity[1]));
}

}  // namespace

std::vector<ExpectedFlow> expected_flows(const Scene& scene, std::int64_t particles, const Model& model) {
    std::vector<ExpectedFlow> all;
    const Calibration& table = scene.flow_table();
    for (const PhaseModel& phase : model.phases) {
        const Phase& wanted = scene.phase(phase.label);
        if (!wanted.norton) continue;
        ExpectedFlow found;
        found.phase = wanted.name;
        found.label = wanted.label;
        found.stress = wanted.norton->stress(scene.highest_rate()) * pascal_per_megapascal;
        switch (scene.law()) {
            case Law::bilin:
                look_at_bilin(*table.bilin, scene, *wanted.norton, phase, model.time_step, found);
                check_sample(*table.bilin, scene, wanted, particles, found);
                break;
            case Law::trilin:
                look_at_trilin(*table.trilin, scene, *wanted.norton, phase, found);
                check_sample(*table.trilin, scene, wanted, particles, found);
                break;
            case Law::norton:
                look_at_norton(*table.norton, scene, *wanted.norton, found);
                check_sample(*table.norton, scene, wanted, particles, found);
                break;
        }
        found.error = std::hypot(std::hypot(found.packings, found.rates), std::hypot(found.size, found.time_step));
        all.push_back(found);
    }
    return all;
}

}  // namespace tomodem
