#include "core/scene/norton_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using C = law::NortonConstants;

constexpr double pascal_per_megapascal = 1e6;

constexpr double usual_equilibrium_error = 0.02;
/// m rate^2 / (K rate^M d): more makes no step longer that matters, and a jump of the rate would be lost in inertia.
constexpr double greatest_inertia = 1e-3;

/// Shares of m / (eta d) and of the cores' period that are stable: at 0.15 bursts of kinetic energy were seen.
constexpr double viscous_share = 0.1, elastic_share = 0.05;
/// Local rates over the lowest: viscosity for the time step, and where it ceases to grow.
constexpr double slow_share = 0.5, least_share = 0.1;

struct Limits {
    double inertia, viscous, elastic;  ///< [-], s, s
};

Limits limits(const Scene& scene, const Packing& sample, const Model& model) {
    const double d = 2 * scene.seed_radius, rate = scene.highest_rate();
    const auto [low, high] = std::minmax_element(sample.position.begin(), sample.position.end(),
                                                 [&](auto& a, auto& b) { return a[scene.axis] < b[scene.axis]; });
    const double height = ((*high)[scene.axis] - (*low)[scene.axis]) / (2 * sample.seed_radius);
    const double error = scene.equilibrium_error.value_or(usual_equilibrium_error);
    Limits found{std::min(greatest_inertia, 12 * error * C::volume / std::max(1.0, height * height)), 0, 0};
    double softest = 1e300, stickiest = 0, strongest = 0;
    for (const law::NortonMaterial& one : model.norton->materials) {
        softest = std::min(softest, one.consistency * std::pow(rate, one.rate_sensitivity));
        stickiest =
            std::max(stickiest, one.consistency * std::pow(slow_share * scene.lowest_rate(), one.rate_sensitivity - 1));
        strongest = std::max(strongest, one.strength);
    }
    const double mass = found.inertia * softest * d / (rate * rate);
    found.viscous = viscous_share * mass / (stickiest * d);
    found.elastic = elastic_share * 2 * std::numbers::pi * std::sqrt(mass / (C::core_stiffness * strongest * d));
    return found;
}

}  // namespace

void add_norton(const Scene& scene, const Packing& sample, Model& model) {
    const double d = 2 * scene.seed_radius, rate = scene.highest_rate();
    model.norton.emplace();
    model.norton->seed_diameter = d;
    model.norton->flow_rate = rate;
    model.norton->least_rate = least_share * scene.lowest_rate();
    const NortonCalibration& calibration = *scene.flow_table().norton;
    double softest = 1e300;
    for (const PhaseModel& phase : model.phases) {
        const Norton& wanted = *scene.phase(phase.label).norton;
        const double consistency = wanted.consistency * pascal_per_megapascal / calibration.flow;
        model.norton->materials.push_back(
            {consistency, wanted.rate_sensitivity,
             consistency * std::pow(scene.reference_rate.value_or(rate), wanted.rate_sensitivity)});
        softest = std::min(softest, consistency * std::pow(rate, wanted.rate_sensitivity));
    }
    const Limits found = limits(scene, sample, model);
    const double longest = std::min(found.viscous, found.elastic);
    model.time_step = scene.time_step.value_or(longest);
    if (model.time_step > longest * (1 + 1e-9))
        throw InvalidInput(
            fmt::format("scene '{}': time_step {:g} s is longer than law \"norton\" is stable with, "
                        "{:.3g} s here; take a smaller one, or none",
                        scene.path.string(), model.time_step, longest));
    const double mass = found.inertia * softest * d / (rate * rate);
    for (std::size_t k = 0; k < model.phases.size(); ++k) {
        PhaseModel& phase = model.phases[k];
        const double stiffness = C::core_stiffness * model.norton->materials[k].strength * d;
        phase.pair = {C::core * d, C::crown * d, stiffness, 0};
        phase.mass = mass;
        phase.natural_period = 2 * std::numbers::pi * std::sqrt(mass / stiffness);
        phase.chi = 0;
    }
}

std::string norton_time_step_reason(const Scene& scene, const Packing& sample, const Model& model) {
    if (scene.time_step) return "given in [accuracy]";
    const Limits found = limits(scene, sample, model);
    const std::string inertia = found.inertia < greatest_inertia
                                    ? fmt::format("inertia of {:g} of the stress at this height",
                                                  scene.equilibrium_error.value_or(usual_equilibrium_error))
                                    : fmt::format("the greatest mass, {:g} K rate^M d / rate^2", greatest_inertia);
    return found.viscous < found.elastic ? fmt::format("viscous stability at half the lowest rate, with {}", inertia)
                                         : fmt::format("the period of the elastic cores, with {}", inertia);
}

}  // namespace tomodem
