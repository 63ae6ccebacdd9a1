#include "core/scene/expected_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/scene/law.hpp"

namespace tomodem {
namespace {

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

}  // namespace

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

std::vector<ExpectedFlow> expected_flows(const Scene& scene, std::int64_t particles, const Model& model) {
    std::vector<ExpectedFlow> all;
    for (const PhaseModel& phase : model.phases) {
        const Phase& wanted = scene.phase(phase.label);
        if (!wanted.norton) continue;
        ExpectedFlow found;
        found.phase = wanted.name;
        found.label = wanted.label;
        found.stress = wanted.norton->stress(scene.highest_rate()) * pascal_per_megapascal;
        check_sample(scene.law().expect(scene, wanted, phase, model, found), scene, wanted, particles, found);
        found.error = std::hypot(std::hypot(found.packings, found.rates), std::hypot(found.size, found.time_step));
        all.push_back(found);
    }
    return all;
}

}  // namespace tomodem
