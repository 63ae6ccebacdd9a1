#include "core/scene/laws/crown_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/reporter.hpp"
#include "core/base/toml_reader.hpp"
#include "core/base/units.hpp"

namespace tomodem {
namespace {

/// Steps that the light particle of a mixed pair needs for a swing on the pair's stiffness: with 5 particles are lost.
constexpr double min_steps_per_mixed_period = 6.0;

/// Ratio of the stiffnesses of two phases up to which the softer one flows as it should (a layer under a hard one: 10
/// right on four packings, 30 scatters, 100 gives 0.67 to 1.10 of the soft phase alone).
constexpr double stiffness_ratio_warned = 10;

/// A soft light particle between stiff ones swings faster than the period of its own phase.
void refuse_unstable_pairs(const Scene& scene, const Model& model) {
    for (const PhaseModel& light : model.phases)
        for (const PhaseModel& other : model.phases) {
            const double stiffness = law::mixed(light.pair, other.pair).repulsive_stiffness;
            const double period = light.natural_period * std::sqrt(light.pair.repulsive_stiffness / stiffness);
            if (period >= min_steps_per_mixed_period * model.time_step) continue;
            const Phase& phase = scene.phase(light.label);
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] is so much softer than [phase.{}] that its particles swing within "
                "{:.2g} time steps between those of the other, which is unstable below {:g}; take phases of closer "
                "stiffness, a longer natural_period of the soft one, or a smaller time_step with the periods given",
                scene.path.string(), phase.line, phase.name, scene.phase(other.label).name, period / model.time_step,
                min_steps_per_mixed_period));
        }
}

}  // namespace

void CrownLaw::read_phase(TomlReader& reader, Phase& phase) const {
    phase.repulsive_stiffness = reader.optional_positive("repulsive_stiffness", units::stiffness);
    phase.natural_period = reader.optional_positive("natural_period", units::time);
    phase.stiffness_ratio = reader.optional_positive("stiffness_ratio").value_or(usual_stiffness_ratio_);
}

void CrownLaw::check_phase(const TomlReader& reader, const Phase& phase) const {
    const bool given = phase.repulsive_stiffness.has_value() && phase.natural_period.has_value();
    const bool any = phase.repulsive_stiffness.has_value() || phase.natural_period.has_value();
    if (phase.norton.has_value() == given || (any && !given))
        reader.fail(fmt::format(
            "[phase.{}] needs either norton = {{ K = .., M = .. }} or both repulsive_stiffness and natural_period",
            phase.name));
}

void CrownLaw::read_accuracy(TomlReader& reader, Scene&) const {
    for (const char* key : {"reference_rate", "inertia_share"})
        reader.refuse(key, fmt::format("{} belongs to law \"norton\"", key));
}

double CrownLaw::strain_per_step(const Scene& scene) const {
    return scene.step_strain();
}

double CrownLaw::max_attraction(const Scene&, const Phase&, double) const {
    return std::numeric_limits<double>::infinity();
}

PhaseModel CrownLaw::compile_phase(const Scene& scene, const Phase& phase, double time_step) const {
    Constants constants{};
    if (phase.norton) {
        try {
            constants = constants_for(scene, *phase.norton, time_step);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("scene '{}' line {}: [phase.{}]: {}", scene.path.string(), phase.line,
                                           phase.name, error.what()));
        }
    } else {
        constants = {*phase.repulsive_stiffness, *phase.natural_period};
    }
    const auto [stiffness, period] = constants;
    if (const double min = traits().min_steps_per_period; period < min * time_step * (1 - 1e-9))
        throw InvalidInput(
            fmt::format("scene '{}' line {}: the natural period {:g} s of [phase.{}] is shorter than {:g} time steps "
                        "of {:g} s, which is unstable; take a smaller time_step or strain_per_step",
                        scene.path.string(), phase.line, period, phase.name, min, time_step));
    check_rate(scene, phase, period, time_step);
    const double rate = scene.highest_rate();
    return {phase.label,
            {2 * scene.seed_radius, 2 * scene.crown_radius, stiffness, stiffness / phase.stiffness_ratio,
             max_attraction(scene, phase, stiffness)},
            period,
            law::mass_for_period(stiffness, period),
            rate * period * period / time_step,
            phase.hardening};
}

void CrownLaw::compile(const Scene& scene, const Packing&, Model& model) const {
    double time_step = strain_per_step(scene) / scene.highest_rate();
    for (const Phase& phase : scene.phases)
        if (phase.natural_period)
            time_step = std::min(time_step, *phase.natural_period / traits().min_steps_per_period);
    model.time_step = scene.time_step.value_or(time_step);
    for (PhaseModel& phase : model.phases) phase = compile_phase(scene, scene.phase(phase.label), model.time_step);
    refuse_unstable_pairs(scene, model);
}

void CrownLaw::warn(const Scene& scene, const Model& model, Reporter& reporter) const {
    if (model.phases.empty()) return;
    const auto [soft, hard] =
        std::minmax_element(model.phases.begin(), model.phases.end(), [](const PhaseModel& a, const PhaseModel& b) {
            return a.pair.repulsive_stiffness < b.pair.repulsive_stiffness;
        });
    const double ratio = hard->pair.repulsive_stiffness / soft->pair.repulsive_stiffness;
    if (ratio > stiffness_ratio_warned * (1 + 1e-9))
        reporter.warn(
            fmt::format("[phase.{}] is {:.3g} times as stiff as [phase.{}]: above {:g} the stress of the softer one "
                        "differs by a third and more from packing to packing; take phases of closer stiffness",
                        scene.phase(hard->label).name, ratio, scene.phase(soft->label).name, stiffness_ratio_warned));
}

}  // namespace tomodem
