#include "solver_plugin/run/relaxation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "solver_plugin/run/guards.hpp"
#include "solver_plugin/run/meter.hpp"
#include "solver_plugin/run/stop_signals.hpp"

namespace tomodem {
namespace {

/// Of a sample without inertia at rest; more is reached in three times the time, and changes nothing.
constexpr double quasi_static_energy_ratio = 1e-2;

}  // namespace

namespace plugin {
namespace {

/// Time between two looks for signals.
constexpr double seconds_of_a_piece = 0.2;

/// Elastic energy over N k_rep r_s^2 of a packing of BILIN at rest: 0.0033 to 0.0036. Where seeds hardly touch (NORTON,
/// a few particles) the kinetic energy is compared with it instead.
constexpr double elastic_energy_at_rest = 0.003;

RestLimits filled(RestLimits limits, const Model& model) {
    const RestLimits own = default_rest_limits(model);
    if (limits.energy_ratio <= 0) limits.energy_ratio = own.energy_ratio;
    if (limits.force_balance <= 0) limits.force_balance = own.force_balance;
    return limits;
}

}  // namespace

std::int64_t Watch::next_piece(std::int64_t step) {
    const auto now = std::chrono::steady_clock::now();
    const double mine[2] = {static_cast<double>(StopSignals::seen()),
                            std::chrono::duration<double>(now - since_).count()};
    double all[2];
    MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, communicator_);
    if (all[0] != 0) throw Stopped{static_cast<int>(all[0])};
    if (step > step_ && all[1] > 0) {
        const double wanted = seconds_of_a_piece * static_cast<double>(step - step_) / all[1];
        piece_ = static_cast<std::int64_t>(std::clamp(wanted, 1.0, 2.0 * static_cast<double>(piece_)));
    }
    since_ = now;
    step_ = step;
    return piece_;
}

Simulation::Watch watching(Watch& watch, const Simulation& simulation) {
    return [&watch, &simulation] { return watch.next_piece(simulation.step()); };
}

void rest_inside(Simulation& simulation, const Model& model, double periods, const Simulation::Watch& watch,
                 Reporter& reporter) {
    const std::int64_t steps = relaxation_steps(model, periods);
    const std::int64_t chunk = model.scheme == Scheme::quasi_static ? 1 : 50;
    const auto progress = reporter.progress("relaxing", static_cast<double>(steps));
    simulation.begin_relaxation();
    for (std::int64_t done = 0; done < steps; done += chunk) {
        simulation.run(std::min(chunk, steps - done), watch);
        refuse_runaway(simulation, simulation.energies().kinetic, model, "during relaxation");
        progress->update(static_cast<double>(done + chunk));
    }
}

Rest relax_inside(Simulation& simulation, const Model& model, const RestLimits& wanted, const Simulation::Watch& watch,
                  Reporter& reporter) {
    const RestLimits limits = filled(wanted, model);
    const std::int64_t period = relaxation_steps(model, 1), most = relaxation_steps(model, limits.max_periods);
    const std::int64_t first = simulation.step();
    const auto progress = reporter.progress("relaxing", 1);
    simulation.begin_relaxation();
    Rest rest;
    double shown = 0;
    for (std::int64_t done = 0; !rest.reached && done < most; done = simulation.step() - first) {
        simulation.run(std::min(period, most - done), watch);
        const Energies energies = simulation.energies();
        refuse_runaway(simulation, energies.kinetic, model, "during relaxation");
        const double kinetic = reduced_energy(simulation, energies.kinetic, model);
        const double elastic = reduced_energy(simulation, energies.seeds, model);
        rest.energy_ratio = kinetic / std::max(elastic, elastic_energy_at_rest);
        const bool last = simulation.step() - first >= most;
        if (rest.energy_ratio <= limits.energy_ratio || last) {
            const ForceBalance forces = simulation.force_balance();
            rest.force_balance = forces.load > 0 ? forces.net / forces.load : 0;
            rest.reached = rest.energy_ratio <= limits.energy_ratio && rest.force_balance <= limits.force_balance;
        }
        shown = std::max(shown, std::log(std::max(rest.energy_ratio, 1e-300)) / std::log(limits.energy_ratio));
        progress->update(std::clamp(shown, 0.0, 1.0));
    }
    rest.periods = static_cast<double>(simulation.step() - first) / static_cast<double>(period);
    if (!rest.reached)
        reporter.warn(fmt::format(
            "the sample is not at rest after {:.0f} natural periods: kinetic over elastic energy is {:.2g} (limit "
            "{:.2g}), net force over load {:.2g} (limit {:.2g}); give more --max-periods to 'relax'",
            rest.periods, rest.energy_ratio, limits.energy_ratio, rest.force_balance, limits.force_balance));
    return rest;
}

}  // namespace plugin

RestLimits default_rest_limits(const Model& model) {
    const LawTraits& law = model.law->traits();
    // A viscous sample creeps on for ever. The particles move by about a diameter in the time of the load's strain of
    // one: with the masses that the energy is counted with, it is 2e-5 (v / d rate)^2.
    if (model.scheme == Scheme::quasi_static)
        return {.energy_ratio = quasi_static_energy_ratio, .force_balance = law.max_force_balance};
    return {.energy_ratio = law.max_energy_ratio, .force_balance = law.max_force_balance};
}

double expected_relaxation_periods(std::int64_t particles) {
    return 40 * std::cbrt(static_cast<double>(particles) / 2000);  // its faces draw in
}

Relaxation come_to_rest(const Packing& sample, const Scene& scene, const RestLimits& limits, MPI_Comm communicator,
                        Reporter& reporter) {
    const StopSignals signals;
    const Meter meter(communicator);
    const Model model = compile_model(scene, sample);
    plugin::Simulation simulation(sample, model, scene.axis, communicator);
    plugin::Watch watch(communicator);
    plugin::Rest rest;
    try {
        rest = plugin::relax_inside(simulation, model, limits, plugin::watching(watch, simulation), reporter);
    } catch (const plugin::Stopped& stop) {
        throw InvalidInput(fmt::format("stopped by {} while the sample was relaxed: nothing is kept of this relaxation",
                                       StopSignals::name(stop.signal)));
    }
    Relaxation result;
    result.at_rest = rest.reached;
    result.periods = rest.periods;
    result.energy_ratio = rest.energy_ratio;
    result.force_balance = rest.force_balance;
    result.residual_energy = reduced_energy(simulation, simulation.energies().kinetic, model);
    result.sample = sample;
    result.sample.position = simulation.positions();
    for (int axis = 0; axis < 3; ++axis)
        result.sample.box.periodic[axis] = model.lateral != Lateral::free && axis != scene.axis;
    result.sample.relaxed = true;
    for (std::size_t k = 0; k < result.sample.position.size(); ++k)
        result.largest_displacement = std::max(
            result.largest_displacement, (result.sample.position[k] - sample.position[k]).norm() / sample.seed_radius);
    result.cost = meter.cost(simulation.step(), simulation.neighbour_builds());
    result.cost.evaluations = simulation.evaluations();
    return result;
}

}  // namespace tomodem
