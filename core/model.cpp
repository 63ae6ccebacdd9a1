#include "core/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"

namespace tomodem {
namespace {

constexpr double pascal_per_megapascal = 1e6;

PhaseModel compile_phase(const Scene& scene, const Phase& phase, double time_step) {
    const double rate = scene.highest_rate();
    const double shortest_period = law::least_steps_per_period * time_step;
    double stiffness = 0, period = 0;
    if (phase.norton) {
        double chi = 0;
        try {
            chi = law::bilin_chi_for(phase.norton->rate_sensitivity);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("scene '{}' line {}: [phase.{}]: {}", scene.path.string(), phase.line,
                                           phase.name, error.what()));
        }
        period = std::max(shortest_period, std::sqrt(chi * time_step / rate));
        stiffness = phase.norton->stress(rate) * pascal_per_megapascal * 2 * scene.seed_radius /
                    law::bilin_master_curve(rate * period * period / time_step);
    } else {
        stiffness = *phase.repulsive_stiffness;
        period = *phase.natural_period;
    }
    if (period < shortest_period * (1 - 1e-9))
        throw InvalidInput(
            fmt::format("scene '{}' line {}: the natural period {:g} s of [phase.{}] is shorter than {:g} time steps "
                        "of {:g} s, which "
                        "is unstable; take a smaller time_step or strain_per_step",
                        scene.path.string(), phase.line, period, phase.name, law::least_steps_per_period, time_step));
    return {phase.label,
            {2 * scene.seed_radius, 2 * scene.crown_radius, stiffness, stiffness / phase.stiffness_ratio},
            period,
            law::mass_for_period(stiffness, period),
            rate * period * period / time_step};
}

}  // namespace

Model compile_model(const Scene& scene, const Packing& sample) {
    const std::set<std::int32_t> present(sample.species.begin(), sample.species.end());
    for (const Phase& phase : scene.phases) {
        if (!present.contains(phase.label))
            throw InvalidInput(
                fmt::format("scene '{}' line {}: [phase.{}] has no particle: the sample has none of label {}",
                            scene.path.string(), phase.line, phase.name, phase.label));
        if (phase.objects && sample.object.empty())
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] has objects = true but the sample does not tell objects apart; "
                "make it with vol2pack --objects {}",
                scene.path.string(), phase.line, phase.name, phase.label));
    }
    Model model;
    model.seed_radius = scene.seed_radius;
    model.crown_radius = scene.crown_radius;
    double time_step = scene.strain_per_step / scene.highest_rate();
    for (const Phase& phase : scene.phases)
        if (phase.natural_period) time_step = std::min(time_step, *phase.natural_period / law::least_steps_per_period);
    model.time_step = scene.time_step.value_or(time_step);
    for (std::int32_t label : present)
        model.phases.push_back(compile_phase(scene, scene.phase(label), model.time_step));
    return model;
}

}  // namespace tomodem
