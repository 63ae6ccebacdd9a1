#include "solver_plugin/run/guards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/scene/load_path.hpp"

namespace tomodem {

using plugin::Simulation;

namespace {

/// Kinetic energy over N k_rep r_s^2 above which a packing is falling apart (a calm one has 1e-6 or less).
constexpr double runaway_energy = 0.05;
/// Elastic energy over N k_rep r_s^2 above which the packing has collapsed: seeds overlap by 0.26 r_s in the mean. At
/// the upper end of BILIN's rate sensitivity (chi = 41) it is 0.02.
constexpr double collapse_energy = 0.2;

/// Way of a plane in one time step over the crown radius: a particle must see a plane come (thesis: at most a tenth).
constexpr double plane_way_refused = 0.5;
constexpr double plane_way_warned = 0.1;

/// Share of the particles that the planes may have passed: the end of a strut that bears a load alone is pressed in
/// that far, and pushed back out as the wall's force goes on rising behind it.
constexpr double overrun_share = 1e-3;

/// The same way in one natural period. A particle that a plane hits is dug into by 1/(2 pi) of it.
constexpr double plane_way_in_period_warned = 1;

bool is_quasi_static(const Model& model) {
    return model.scheme == Scheme::quasi_static;
}

/// Advice, in the keys that the scene has.
std::string calmer(const Model& model) {
    const std::string finer = "parts that are one or two particles thick need a sample of finer particles";
    if (is_quasi_static(model)) return "take a smaller strain_per_step or max_imbalance; " + finer;
    return fmt::format("take a lower rate, a smaller {}, or a shorter natural_period if the scene gives one; {}",
                       model.law->traits().less_heat, finer);
}

/// Nobody may jump over particles in one step of quasi-static flow; a shorter step costs but more steps.
/// @param way     in one step, over the crown radius
void refuse_long_way(const std::string& what, double way) {
    if (way > plane_way_refused)
        throw InvalidInput(
            fmt::format("{} by {:.2g} crown radii in one step, at most {:g}; take a smaller strain_per_step", what, way,
                        plane_way_refused));
}

void check_quasi_static_speed(const Scene& scene, const Model& model, double height, double seed_radius) {
    if (!scene.steps.empty())
        refuse_long_way("the planes move", 0.5 * model.strain_per_step * height / model.crown_radius);
    const double crown = model.crown_radius * seed_radius / model.seed_radius;
    const std::vector<LoadSegment> path = load_path(scene, model);
    const std::vector<LoadClock> clocks = clocks_of(path);
    std::int64_t step = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
        const double begin = clocks[k].at(step), end = clocks[k].at(step += path[k].steps);
        for (const Wall& wall : scene.walls)
            if (wall.start < end && wall.stop > begin)
                refuse_long_way(fmt::format("[[wall]] '{}' moves", wall.name),
                                Vec3(wall.velocity.data()).norm() * path[k].time_step / crown);
    }
}

}  // namespace

double reduced_energy(const Simulation& simulation, double energy, const Model& model) {
    double stiffest = 0;
    for (const PhaseModel& phase : model.phases) stiffest = std::max(stiffest, phase.pair.repulsive_stiffness);
    const double seed_radius = simulation.seed_radius();
    const double stiffness = stiffest * seed_radius / model.seed_radius;
    return energy / (static_cast<double>(simulation.initial_particles()) * stiffness * seed_radius * seed_radius);
}

void refuse_runaway(const Simulation& simulation, double kinetic_energy, const Model& model, const std::string& when) {
    const std::int64_t lost = simulation.initial_particles() - simulation.particles();
    if (lost != 0)
        throw InvalidInput(fmt::format("{} particles were lost {} (step {}); take a smaller strain_per_step", lost,
                                       when, simulation.step()));
    // Velocities that balance the forces do not run away, and have no energy to speak of.
    if (is_quasi_static(model)) return;
    // A soft phase can fly apart with less than what a stiff one has at rest.
    const double energy =
        std::max(reduced_energy(simulation, kinetic_energy, model), simulation.max_kinetic_energy_of_a_phase());
    if (!(energy < runaway_energy))
        throw InvalidInput(fmt::format(
            "the packing falls apart {} (step {}): its kinetic energy is {:.2g} N k_rep r_s^2, above {:g}; {}", when,
            simulation.step(), energy, runaway_energy, calmer(model)));
}

void refuse_heat(const Simulation& simulation, double kinetic_energy, const Model& model, const std::string& when) {
    const LawTraits& law = model.law->traits();
    // Velocities that balance the forces hold no heat: a part that has torn off may be pulled back fast.
    if (!std::isfinite(law.max_heat) || is_quasi_static(model)) return;
    const double flow = simulation.flow_energy();
    if (flow > 0 && kinetic_energy > law.max_heat * flow)
        throw InvalidInput(
            fmt::format("the packing heats up {} (step {}): its kinetic energy is {:.2g} times that of the flow, above "
                        "{:g}; take a smaller time_step or {}",
                        when, simulation.step(), kinetic_energy / flow, law.max_heat, law.less_heat));
}

void refuse_collapse(const Simulation& simulation, double elastic_energy, const Model& model, const std::string& when) {
    const auto overrun = simulation.particles_behind_planes();
    if (static_cast<double>(overrun) > overrun_share * static_cast<double>(simulation.initial_particles()))
        throw InvalidInput(fmt::format(
            "the planes have run over {} particles {} (step {}): they are too fast for particles this heavy; {}",
            overrun, when, simulation.step(), calmer(model)));
    const double energy = reduced_energy(simulation, elastic_energy, model);
    if (!(energy < collapse_energy))
        throw InvalidInput(fmt::format(
            "the packing has collapsed {} (step {}): the elastic energy of its seeds is {:.2g} N k_rep r_s^2, above "
            "{:g}; is the seed radius of the sample right? Otherwise {}",
            when, simulation.step(), energy, collapse_energy, calmer(model)));
}

void check_plane_speed(const Scene& scene, const Model& model, const Packing& sample, Reporter& reporter) {
    if (scene.steps.empty() && !is_quasi_static(model)) return;
    double low = 1e300, high = -1e300;
    for (const Vec3& point : sample.position) {
        low = std::min(low, point[scene.axis]);
        high = std::max(high, point[scene.axis]);
    }
    double highest_strain = 0;
    for (const LoadStep& step : scene.steps) highest_strain = std::max(highest_strain, step.strain);
    const double height = (high - low) * model.seed_radius / sample.seed_radius * std::exp(highest_strain);
    if (is_quasi_static(model)) return check_quasi_static_speed(scene, model, height, sample.seed_radius);
    const double speed = 0.5 * scene.highest_rate() * height / model.crown_radius;
    const double way = speed * model.time_step;
    const std::string what = fmt::format(
        "the planes move by {:.2g} crown radii in one time step (critical regime: particles do not see them come)",
        way);
    if (way > plane_way_refused)
        throw InvalidInput(
            fmt::format("{}, at most {:g}; take a smaller time_step or strain_per_step", what, plane_way_refused));
    if (way > plane_way_warned) reporter.warn(fmt::format("{}; better below {:g}", what, plane_way_warned));
    for (const PhaseModel& phase : model.phases)
        if (speed * phase.natural_period > plane_way_in_period_warned)
            reporter.warn(fmt::format(
                "the planes move by {:.2g} crown radii in one natural period of label {} ({:.3g} s): "
                "its inertia carries the load; better below {:g}",
                speed * phase.natural_period, phase.label, phase.natural_period, plane_way_in_period_warned));
}

}  // namespace tomodem
