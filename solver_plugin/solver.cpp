#include "solver_plugin/solver.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <optional>

#include "core/cli.hpp"
#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "core/packing_file.hpp"
#include "solver_plugin/simulation.hpp"

namespace tomodem {
namespace {

using plugin::PlaneForces;
using plugin::Simulation;

/// Kinetic energy over N k_rep r_s^2 above which a packing is falling apart (a calm one has 1e-6 or less).
constexpr double runaway_energy = 0.05;
constexpr int points_per_window = 10;
/// Natural periods of rest between planes that pull, for the faces to lie against them.
constexpr double seating_periods = 20;

class Meter {
 public:
    explicit Meter(MPI_Comm communicator) : communicator_(communicator), cpu_(own_cpu()) {}

    Cost cost(std::int64_t steps, std::int64_t builds) const {
        Cost cost;
        cost.steps = steps;
        cost.neighbour_builds = builds;
        cost.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        const double mine[2] = {own_cpu() - cpu_, peak()};
        double all[2];
        MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, communicator_);
        cost.cpu_seconds = all[0];
        cost.peak_bytes = static_cast<std::int64_t>(all[1]);
        MPI_Comm_size(communicator_, &cost.processes);
        return cost;
    }

 private:
    static double own_cpu() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_utime.tv_sec + usage.ru_stime.tv_sec + 1e-6 * (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }
    static double peak() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss * 1024.0;
    }
    MPI_Comm communicator_;
    double cpu_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool first_process(MPI_Comm communicator) {
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    return rank == 0;
}

/// Kinetic energy over N k_rep r_s^2, with the stiffest phase, in the sample's lengths.
double reduced_energy(double kinetic, const Model& model, const Packing& sample) {
    double stiffest = 0;
    for (const PhaseModel& phase : model.phases) stiffest = std::max(stiffest, phase.pair.repulsive_stiffness);
    const double stiffness = stiffest * sample.seed_radius / model.seed_radius;
    return kinetic / (static_cast<double>(sample.size()) * stiffness * sample.seed_radius * sample.seed_radius);
}

void refuse_runaway(const Simulation& simulation, double kinetic_energy, const Model& model, const Packing& sample,
                    const std::string& when) {
    if (simulation.particles() != static_cast<std::int64_t>(sample.size()))
        throw InvalidInput(fmt::format("{} particles were lost {} (step {}); take a smaller strain_per_step",
                                       sample.size() - simulation.particles(), when, simulation.step()));
    // A soft phase can fly apart with less than what a stiff one has at rest.
    const double energy = std::max(reduced_energy(kinetic_energy, model, sample), simulation.hottest_phase());
    if (!(energy < runaway_energy))
        throw InvalidInput(fmt::format(
            "the packing falls apart {} (step {}): its kinetic energy is {:.2g} N k_rep r_s^2, above {:g}; take a "
            "lower rate, a smaller strain_per_step, or a shorter natural_period",
            when, simulation.step(), energy, runaway_energy));
}

void relax_inside(Simulation& simulation, const Model& model, const Packing& sample, double periods) {
    const auto steps = static_cast<std::int64_t>(std::ceil(periods * law::least_steps_per_period));
    constexpr std::int64_t chunk = 50;
    cli::Progress progress("relaxing", static_cast<double>(steps));
    simulation.begin_relaxation();
    for (std::int64_t done = 0; done < steps; done += chunk) {
        simulation.run(std::min(chunk, steps - done));
        refuse_runaway(simulation, simulation.energies().kinetic, model, sample, "during relaxation");
        progress.update(static_cast<double>(done + chunk));
    }
}

/// Means of the plane forces over the last window of strain, point by point.
class ForceWindow {
 public:
    void add(const PlaneForces& forces) {
        recent_.push_back(forces);
        if (recent_.size() > points_per_window) recent_.pop_front();
    }
    PlaneForces mean() const {
        PlaneForces sum;
        for (const PlaneForces& forces : recent_) {
            sum.top += forces.top * static_cast<double>(forces.steps);
            sum.bottom += forces.bottom * static_cast<double>(forces.steps);
            sum.steps += forces.steps;
        }
        sum.top /= static_cast<double>(sum.steps);
        sum.bottom /= static_cast<double>(sum.steps);
        return sum;
    }

 private:
    std::deque<PlaneForces> recent_;
};

struct Point {
    double strain, stress_true, stress_engineering, force_top, force_bottom, equilibrium_error, section;
};

Point measure(double strain, const PlaneForces& forces, double initial_section) {
    Point point{};
    point.strain = strain;
    point.force_top = forces.top;
    // The sample pushes or pulls the two planes in opposite directions; with the sign of the axis they add up to zero.
    point.force_bottom = -forces.bottom;
    const double force = (forces.top + forces.bottom) / 2;
    const double magnitude = (std::abs(forces.top) + std::abs(forces.bottom)) / 2;
    point.section = initial_section * std::exp(-strain);
    point.stress_true = force / point.section;
    point.stress_engineering = force / initial_section;
    point.equilibrium_error = magnitude > 0 ? std::abs(point.force_top + point.force_bottom) / magnitude : 0;
    return point;
}

void record(RunWriter& writer, const Point& point, const plugin::Energies& energies, std::int64_t step, double time) {
    const auto add = [&](const char* name, const char* unit, double value) {
        writer.add_observable(name, unit, step, time, value);
    };
    add("strain", "", point.strain);
    add("stress_true", "Pa", point.stress_true);
    add("stress_engineering", "Pa", point.stress_engineering);
    add("force_top", "uN", point.force_top);
    add("force_bottom", "uN", point.force_bottom);
    add("equilibrium_error", "", point.equilibrium_error);
    add("kinetic_energy", "nJ", energies.kinetic);
    add("potential_energy", "nJ", energies.seeds);
    add("section", "mm^2", point.section);
}

}  // namespace

Relaxation relax(const Packing& sample, const Scene& scene, double periods, MPI_Comm communicator) {
    const Meter meter(communicator);
    const Model model = compile_model(scene, sample);
    Simulation simulation(sample, model, scene.axis, communicator);
    relax_inside(simulation, model, sample, periods);
    Relaxation result;
    result.residual_energy = reduced_energy(simulation.energies().kinetic, model, sample);
    result.sample = sample;
    result.sample.position = simulation.positions();
    result.sample.box.periodic = {false, false, false};
    result.sample.relaxed = true;
    for (std::size_t k = 0; k < result.sample.position.size(); ++k)
        result.largest_displacement = std::max(
            result.largest_displacement, (result.sample.position[k] - sample.position[k]).norm() / sample.seed_radius);
    result.cost = meter.cost(simulation.step(), simulation.neighbour_builds());
    return result;
}

RunResult solve(const Packing& sample, const Scene& scene, const std::filesystem::path& run_file,
                const Provenance& provenance, MPI_Comm communicator) {
    const Meter meter(communicator);
    const Model model = compile_model(scene, sample);
    const bool first = first_process(communicator);
    Simulation simulation(sample, model, scene.axis, communicator);
    if (!sample.relaxed) {
        cli::note("the sample is not relaxed yet: relaxing it first");
        relax_inside(simulation, model, sample, default_relaxation_periods);
        simulation.end_relaxation();
    }

    Packing pressed = sample;
    pressed.box.periodic = {false, false, false};
    pressed.relaxed = true;
    if (auto points = simulation.positions(); first) pressed.position = std::move(points);
    std::optional<RunWriter> writer;
    if (first) writer.emplace(pressed, run_file, provenance);

    simulation.place_planes();
    if (model.trilin) {
        relax_inside(simulation, model, sample, seating_periods);
        simulation.end_relaxation();
    }
    const Vec3 edges = sample.box.edges;
    const double initial_section = edges[(scene.axis + 1) % 3] * edges[(scene.axis + 2) % 3];

    RunResult result;
    result.time_step = model.time_step;
    result.particles = static_cast<std::int64_t>(sample.size());

    const std::int64_t start = simulation.step();
    const auto write_frame = [&] {
        const std::int64_t step = simulation.step() - start;
        std::vector<Vec3> points = simulation.positions();
        if (first) writer->add_frame({step, static_cast<double>(step) * model.time_step, std::move(points)});
    };
    write_frame();
    simulation.run(0);
    if (const plugin::Energies at_rest = simulation.energies(); first)
        record(*writer, measure(0, {}, initial_section), at_rest, 0, 0);

    const double path = scene.path_length();
    const double point_spacing = scene.averaging_strain / points_per_window;
    const double frame_spacing = path / static_cast<double>(scene.frames);
    cli::Progress progress("pressing", path);
    ForceWindow window;
    double reached = 0, travelled = 0, error_sum = 0;
    std::int64_t frames_written = 0, error_points = 0;
    for (const LoadStep& load : scene.steps) {
        const double change = load.strain - reached;
        const auto steps =
            static_cast<std::int64_t>(std::max(1.0, std::round(std::abs(change) / (load.rate * model.time_step))));
        // A whole number of steps that ends exactly on the target.
        const double strain_per_step = change / static_cast<double>(steps);
        simulation.set_loading(reached, strain_per_step / model.time_step);
        const auto points = std::max<std::int64_t>(1, std::llround(std::abs(change) / point_spacing));
        for (std::int64_t point = 0; point < points; ++point) {
            const std::int64_t chunk = steps * (point + 1) / points - steps * point / points;
            if (chunk == 0) continue;
            simulation.run(chunk);
            travelled += std::abs(strain_per_step) * static_cast<double>(chunk);
            const plugin::Energies energies = simulation.energies();
            refuse_runaway(simulation, energies.kinetic, model, sample,
                           fmt::format("at strain {:.3f}", simulation.strain()));
            window.add(simulation.take_forces());
            const Point measured = measure(simulation.strain(), window.mean(), initial_section);
            const std::int64_t step = simulation.step() - start;
            if (first) record(*writer, measured, energies, step, static_cast<double>(step) * model.time_step);
            if (travelled > path / 2) {
                error_sum += measured.equilibrium_error;
                ++error_points;
            }
            result.final_stress = measured.stress_true;
            result.final_strain = measured.strain;
            if (travelled >= (frames_written + 1) * frame_spacing * (1 - 1e-9)) {
                write_frame();
                frames_written = static_cast<std::int64_t>(travelled / frame_spacing * (1 + 1e-9));
            }
            progress.update(travelled);
        }
        reached = load.strain;
    }
    result.mean_equilibrium_error = error_points > 0 ? error_sum / static_cast<double>(error_points) : 0;
    result.particles_lost = result.particles - simulation.particles();
    result.cost = meter.cost(simulation.step(), simulation.neighbour_builds());
    if (first) writer->commit();
    return result;
}

}  // namespace tomodem
