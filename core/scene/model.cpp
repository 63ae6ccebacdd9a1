#include "core/scene/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "core/law/trilin_flow.hpp"
#include "core/scene/norton_model.hpp"

namespace tomodem {
namespace {

constexpr double pascal_per_megapascal = 1e6;

/// A time step above this share of the natural period loses particles or falsifies the stress.
double least_steps_per_period(Law law) {
    return law == Law::bilin ? law::least_steps_per_period : law::trilin_steps_per_period;
}

/// Steps that the light particle of a mixed pair needs for a swing on the pair's stiffness: with 5 particles are lost.
constexpr double least_steps_per_mixed_period = 6.0;

/// A soft light particle between stiff ones swings faster than the period of its own phase.
void refuse_unstable_pairs(const Scene& scene, const Model& model) {
    for (const PhaseModel& light : model.phases)
        for (const PhaseModel& other : model.phases) {
            const double stiffness = law::mixed(light.pair, other.pair).repulsive_stiffness;
            const double period = light.natural_period * std::sqrt(light.pair.repulsive_stiffness / stiffness);
            if (period >= least_steps_per_mixed_period * model.time_step) continue;
            const Phase& phase = scene.phase(light.label);
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] is so much softer than [phase.{}] that its particles swing within "
                "{:.2g} time steps between those of the other, which is unstable below {:g}; take phases of closer "
                "stiffness, a longer natural_period of the soft one, or a smaller time_step with the periods given",
                scene.path.string(), phase.line, phase.name, scene.phase(other.label).name, period / model.time_step,
                least_steps_per_mixed_period));
        }
}

struct Constants {
    double stiffness, period;
};

Constants bilin_constants(const Calibration& table, const Norton& norton, double rate, double time_step,
                          double seed_radius) {
    const law::BilinFlow& curve = table.bilin->curve;
    const double chi = curve.chi_for(norton.rate_sensitivity);
    const double period = std::max(law::least_steps_per_period * time_step, std::sqrt(chi * time_step / rate));
    const double stress = norton.stress(rate) * pascal_per_megapascal;
    return {stress * 2 * seed_radius / curve.at(rate * period * period / time_step), period};
}

Constants trilin_constants(const Calibration& table, const Norton& norton, double rate, double time_step,
                           double seed_radius) {
    const law::TrilinFlow& flow = table.trilin->flow;
    if (std::abs(norton.rate_sensitivity - flow.sensitivity) > flow.tolerance) {
        const bool bilin = table.bilin && norton.rate_sensitivity <= table.bilin->curve.greatest_sensitivity;
        throw InvalidInput(
            fmt::format("M = {:g} is out of reach of law \"trilin\", whose rate sensitivity is {:g} within {:g}; {}",
                        norton.rate_sensitivity, flow.sensitivity, flow.tolerance,
                        bilin ? "under compression law \"bilin\" can, in tension too law \"norton\""
                              : "law \"norton\" can, for any M up to 1"));
    }
    const double period = law::trilin_steps_per_period * time_step;
    const double stress = norton.stress(rate) * pascal_per_megapascal;
    return {stress * 2 * seed_radius / flow.at(rate * period), period};
}

/// A table of one's own need not hold every law; constants that are given need none.
void require_calibration(const Scene& scene) {
    const Calibration& table = scene.flow_table();
    const auto phase = std::find_if(scene.phases.begin(), scene.phases.end(), [](auto& one) { return one.norton; });
    if (phase == scene.phases.end()) return;
    const auto [held, name] = scene.law() == Law::bilin    ? std::pair(table.bilin.has_value(), "bilin")
                              : scene.law() == Law::trilin ? std::pair(table.trilin.has_value(), "trilin")
                                                           : std::pair(table.norton.has_value(), "norton");
    if (!held)
        throw InvalidInput(
            fmt::format("scene '{}' line {}: [phase.{}] has law \"{}\", which the calibration '{}' does not hold; make "
                        "it with pipelines/calibrate LAWS={}, or remove calibration from [accuracy]",
                        scene.path.string(), phase->line, phase->name, name, table.name, name));
}

PhaseModel compile_phase(const Scene& scene, const Phase& phase, double time_step) {
    const double rate = scene.highest_rate();
    const bool trilin = phase.law == Law::trilin;
    Constants constants{};
    if (phase.norton) {
        try {
            constants = (trilin ? trilin_constants : bilin_constants)(scene.flow_table(), *phase.norton, rate,
                                                                      time_step, scene.seed_radius);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("scene '{}' line {}: [phase.{}]: {}", scene.path.string(), phase.line,
                                           phase.name, error.what()));
        }
    } else {
        constants = {*phase.repulsive_stiffness, *phase.natural_period};
    }
    const auto [stiffness, period] = constants;
    if (const double least = least_steps_per_period(phase.law); period < least * time_step * (1 - 1e-9))
        throw InvalidInput(
            fmt::format("scene '{}' line {}: the natural period {:g} s of [phase.{}] is shorter than {:g} time steps "
                        "of {:g} s, which is unstable; take a smaller time_step or strain_per_step",
                        scene.path.string(), phase.line, period, phase.name, least, time_step));
    if (const double chi = rate * period * period / time_step; !trilin && chi > law::greatest_chi)
        throw InvalidInput(fmt::format(
            "scene '{}' line {}: [phase.{}] at {:g} /s has rate natural_period^2 / time_step = {:.3g}; above {:g} the "
            "packing collapses; take a lower rate or a shorter natural_period",
            scene.path.string(), phase.line, phase.name, rate, chi, law::greatest_chi));
    if (trilin && rate * period > law::trilin_greatest_rate)
        throw InvalidInput(fmt::format(
            "scene '{}' line {}: [phase.{}] at {:g} /s has rate natural_period = {:.3g}; above {:g} the planes outrun "
            "the packing; take a lower rate or a shorter natural_period",
            scene.path.string(), phase.line, phase.name, rate, rate * period, law::trilin_greatest_rate));
    PhaseModel model{phase.label,
                     {2 * scene.seed_radius, 2 * scene.crown_radius, stiffness, stiffness / phase.stiffness_ratio},
                     period,
                     law::mass_for_period(stiffness, period),
                     rate * period * period / time_step,
                     phase.hardening};
    if (trilin)
        model.pair.greatest_attraction =
            phase.greatest_attraction.value_or(law::trilin_attraction * stiffness * scene.seed_radius);
    return model;
}

void check_lateral_sides(const Scene& scene, const Packing& sample) {
    const auto refuse = [&](const std::string& what) {
        throw InvalidInput(fmt::format("scene '{}' line {}: periodic sides in [load]: {}", scene.path.string(),
                                       scene.load_line, what));
    };
    // A particle must not meet another and its image at once.
    const double least = 4 * scene.crown_radius * sample.seed_radius / scene.seed_radius;
    for (int axis : {(scene.axis + 1) % 3, (scene.axis + 2) % 3}) {
        const char name = "xyz"[axis];
        if (!sample.box.periodic[axis])
            refuse(
                fmt::format("the sample's box is not periodic along {}; take a brick from packgen, relaxed with this "
                            "scene if at all",
                            name));
        if (sample.box.edges[axis] < least)
            refuse(fmt::format("the sample's box is {:g} mm along {}: it needs four crown radii, {:g} mm",
                               sample.box.edges[axis], name, least));
        const auto [low, high] = std::minmax_element(sample.position.begin(), sample.position.end(),
                                                     [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
        if ((*high)[axis] - (*low)[axis] < sample.box.edges[axis] - 4 * sample.seed_radius)
            refuse(fmt::format("the sample does not fill its box along {}: it would not touch its own image", name));
    }
}

/// Equilibrium error over rate t0 where chi sets the natural period: up to 0.68 was measured (phase B at s = 50, 2,000
/// particles), and over the strain in a step on the plateau: 36 to 51 (phase A, 5,000 and 50,000; docs/method.md).
constexpr double error_per_rate_and_period = 0.7;
constexpr double error_per_strain_step = 60;

/// The longest strain in a step whose inertia keeps within the bound on the equilibrium error.
double strain_per_step_for(const Scene& scene, double equilibrium_error) {
    const double longest = equilibrium_error / error_per_rate_and_period;  // rate t0
    double strain_per_step = longest / law::least_steps_per_period;
    for (const Phase& phase : scene.phases) {
        if (phase.norton) {
            const double chi = scene.flow_table().bilin->curve.chi_for(
                phase.norton->rate_sensitivity);  // = (rate t0)^2 / strain_per_step
            const double most = chi > 0 ? longest * longest / chi : equilibrium_error / error_per_strain_step;
            strain_per_step = std::min(strain_per_step, most);
        } else if (const double error = error_per_rate_and_period * scene.highest_rate() * *phase.natural_period;
                   error > equilibrium_error) {
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: the natural period {:g} s of [phase.{}] alone may make an equilibrium error of "
                "{:.2g}, above the {:g} asked for; give a shorter one",
                scene.path.string(), phase.line, *phase.natural_period, phase.name, error, equilibrium_error));
        }
    }
    return strain_per_step;
}

/// A sample brings its radii, or they are drawn.
void check_radii(const Scene& scene, const Packing& sample) {
    if (sample.radius.empty()) return;
    if (scene.radius_dispersion > 0)
        throw InvalidInput(
            fmt::format("scene '{}': radius_dispersion = {:g} but the particles of the sample have radii of their own; "
                        "remove the key, or make the brick without --dispersion",
                        scene.path.string(), scene.radius_dispersion));
    if (scene.law() == Law::norton)
        throw InvalidInput(
            fmt::format("scene '{}': law \"norton\" is made for equal radii but the particles of the sample have radii "
                        "of their own; make the brick without --dispersion",
                        scene.path.string()));
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
    require_calibration(scene);
    Model model;
    model.seed_radius = scene.seed_radius;
    model.crown_radius = scene.crown_radius;
    const bool norton = scene.law() == Law::norton;
    double strain_per_step = scene.strain_per_step;
    if (scene.equilibrium_error && !norton) strain_per_step = strain_per_step_for(scene, *scene.equilibrium_error);
    double time_step = strain_per_step / scene.highest_rate();
    for (const Phase& phase : scene.phases)
        if (phase.natural_period)
            time_step = std::min(time_step, *phase.natural_period / least_steps_per_period(phase.law));
    model.trilin = scene.law() == Law::trilin;
    check_radii(scene, sample);
    model.radius_dispersion = scene.radius_dispersion;
    model.self_contact = scene.self_contact;
    model.healing_time = scene.healing_time;
    model.between_objects = scene.between_objects;
    if (model.between_objects && sample.object.empty())
        throw InvalidInput(
            fmt::format("scene '{}': between_objects = true in [contact] but the sample does not tell "
                        "objects apart; make it with vol2pack --objects LABEL",
                        scene.path.string()));
    model.lateral = scene.lateral;
    if (model.lateral != Lateral::free) check_lateral_sides(scene, sample);
    if (norton) {
        for (std::int32_t label : present) model.phases.push_back({label, {}, 0, 0, 0, scene.phase(label).hardening});
        add_norton(scene, sample, model);
        return model;
    }
    model.time_step = scene.time_step.value_or(time_step);
    for (std::int32_t label : present)
        model.phases.push_back(compile_phase(scene, scene.phase(label), model.time_step));
    refuse_unstable_pairs(scene, model);
    return model;
}

std::int64_t relaxation_steps(const Model& model, double periods) {
    constexpr double strain_of_a_period = 0.003;
    const double steps_of_a_period =
        model.norton ? strain_of_a_period / (model.norton->flow_rate * model.time_step) : law::least_steps_per_period;
    return static_cast<std::int64_t>(std::ceil(periods * steps_of_a_period));
}

}  // namespace tomodem
