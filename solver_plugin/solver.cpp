#include "solver_plugin/solver.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>

#include "core/cli.hpp"
#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "core/load_path.hpp"
#include "core/mesh.hpp"
#include "core/output_file.hpp"
#include "core/packing_file.hpp"
#include "core/run_file.hpp"
#include "solver_plugin/checkpoint.hpp"
#include "solver_plugin/simulation.hpp"
#include "solver_plugin/stop_signals.hpp"

namespace tomodem {
namespace {

using plugin::PlaneForces;
using plugin::Simulation;

/// Kinetic energy over N k_rep r_s^2 above which a packing is falling apart (a calm one has 1e-6 or less).
constexpr double runaway_energy = 0.05;
/// Elastic energy over N k_rep r_s^2 above which the packing has collapsed: seeds overlap by 0.26 r_s in the mean. At
/// the upper end of BILIN's rate sensitivity (chi = 41) it is 0.02.
constexpr double collapse_energy = 0.2;

constexpr int points_per_window = 10;
/// Natural periods of rest between planes that pull, for the faces to lie against them.
constexpr double seating_periods = 20;

/// Of stress, in a point of the curves: 20 in a window.
constexpr int samples_per_point = 2;

/// Steps after which, at the next point of the curves, the solver is set up anew: what a checkpoint can be made of.
constexpr std::int64_t steps_between_rests = 2000;

/// Time between two looks for signals.
constexpr double seconds_of_a_piece = 0.2;

/// Way of a plane in one time step over the crown radius: a particle must see a plane come (thesis: at most a tenth).
constexpr double plane_way_refused = 0.5;
constexpr double plane_way_warned = 0.1;

/// The same way in one natural period. A particle that a plane hits is dug into by 1/(2 pi) of it.
constexpr double plane_way_in_period_warned = 1;

class Meter {
 public:
    explicit Meter(MPI_Comm communicator) : communicator_(communicator), cpu_(own_cpu()) {}

    /// Adds what earlier processes spent on the same run.
    void carry(double wall_seconds, double cpu_seconds) {
        earlier_wall_ = wall_seconds;
        earlier_cpu_ = cpu_seconds;
    }

    Cost cost(std::int64_t steps, std::int64_t builds) const {
        Cost cost;
        cost.steps = steps;
        cost.neighbour_builds = builds;
        cost.wall_seconds =
            earlier_wall_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        const double mine[2] = {own_cpu() - cpu_, peak()};
        double all[2];
        MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, communicator_);
        cost.cpu_seconds = earlier_cpu_ + all[0];
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
    double cpu_, earlier_wall_ = 0, earlier_cpu_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool first_process(MPI_Comm communicator) {
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    return rank == 0;
}

/// A signal asks for the end of the run; thrown on every process.
struct Stopped {
    int signal;
};

/// Looks for signals between steps. What one process sees, all see.
class Watch {
 public:
    explicit Watch(MPI_Comm communicator) : communicator_(communicator) {}

    /// @throws Stopped
    std::int64_t next_piece(std::int64_t step) {
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

 private:
    MPI_Comm communicator_;
    std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
    std::int64_t step_ = 0, piece_ = 16;
};

Simulation::Watch watching(Watch& watch, const Simulation& simulation) {
    return [&watch, &simulation] { return watch.next_piece(simulation.step()); };
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
    const double energy = reduced_energy(kinetic_energy, model, sample);
    if (!(energy < runaway_energy))
        throw InvalidInput(fmt::format(
            "the packing falls apart {} (step {}): its kinetic energy is {:.2g} N k_rep r_s^2, above {:g}; take a "
            "lower rate, a smaller strain_per_step, or a shorter natural_period",
            when, simulation.step(), energy, runaway_energy));
}

/// What only a run under load can do.
void refuse_collapse(const Simulation& simulation, double elastic_energy, const Model& model, const Packing& sample,
                     const std::string& when) {
    if (const std::int64_t overrun = simulation.particles_behind_planes(); overrun > 0)
        throw InvalidInput(fmt::format(
            "the planes have run over {} particles {} (step {}): they are too fast for particles this heavy; take a "
            "lower rate or a shorter natural_period",
            overrun, when, simulation.step()));
    const double energy = reduced_energy(elastic_energy, model, sample);
    if (!(energy < collapse_energy))
        throw InvalidInput(fmt::format(
            "the packing has collapsed {} (step {}): the elastic energy of its seeds is {:.2g} N k_rep r_s^2, above "
            "{:g}; is the seed radius of the sample right? Otherwise take a lower rate or a shorter natural_period",
            when, simulation.step(), energy, collapse_energy));
}

void relax_inside(Simulation& simulation, const Model& model, const Packing& sample, double periods,
                  const Simulation::Watch& watch = {}) {
    const auto steps = static_cast<std::int64_t>(std::ceil(periods * law::least_steps_per_period));
    constexpr std::int64_t chunk = 50;
    cli::Progress progress("relaxing", static_cast<double>(steps));
    simulation.begin_relaxation();
    for (std::int64_t done = 0; done < steps; done += chunk) {
        simulation.run(std::min(chunk, steps - done), watch);
        refuse_runaway(simulation, simulation.energies().kinetic, model, sample, "during relaxation");
        progress.update(static_cast<double>(done + chunk));
    }
}

/// Reads the surfaces of the scene's walls and stands them around the sample.
enum class Room { checked, taken };  ///< whether they may stand inside the sample, as they do later in a run
void place_walls(Simulation& simulation, const Scene& scene, Room room) {
    for (const Wall& wall : scene.walls) {
        const auto refuse = [&](const std::string& what) {
            throw InvalidInput(
                fmt::format("scene '{}' line {}: wall '{}': {}", scene.path.string(), wall.line, wall.name, what));
        };
        try {
            TriangleMesh mesh = read_mesh(wall.surface);
            for (Vec3& vertex : mesh.vertices) vertex *= wall.unit;
            if (const std::int64_t inside = simulation.place_wall(mesh, wall); inside > 0 && room == Room::checked)
                refuse(
                    fmt::format("its surface stands inside the sample: {} particles are nearer than half a seed "
                                "radius; move it, or check its unit",
                                inside));
        } catch (const InvalidInput& error) {
            if (std::string_view(error.what()).starts_with("scene '")) throw;
            refuse(error.what());
        }
    }
}

/// Mean forces of planes and walls on the sample over some steps.
struct Forces {
    PlaneForces planes;
    std::vector<Vec3> walls;
    std::int64_t steps = 0;
};

/// Means of the forces over the last window of strain, point by point.
class ForceWindow {
 public:
    void add(Forces forces) {
        recent_.push_back(std::move(forces));
        if (recent_.size() > points_per_window) recent_.pop_front();
    }
    Forces mean() const {
        Forces mean{{}, std::vector<Vec3>(recent_.front().walls.size(), Vec3::Zero()), 0};
        for (const Forces& forces : recent_) mean.steps += forces.steps;
        for (const Forces& forces : recent_) {
            const double share = static_cast<double>(forces.steps) / static_cast<double>(mean.steps);
            mean.planes.top += share * forces.planes.top;
            mean.planes.bottom += share * forces.planes.bottom;
            for (std::size_t k = 0; k < mean.walls.size(); ++k) mean.walls[k] += share * forces.walls[k];
        }
        return mean;
    }
    std::vector<double> numbers() const {
        std::vector<double> all;
        for (const Forces& forces : recent_) {
            all.insert(all.end(), {forces.planes.top, forces.planes.bottom, static_cast<double>(forces.planes.steps),
                                   static_cast<double>(forces.steps)});
            for (const Vec3& force : forces.walls) all.insert(all.end(), force.begin(), force.end());
        }
        return all;
    }
    void restore(const std::vector<double>& numbers, std::size_t walls) {
        recent_.clear();
        for (auto at = numbers.begin(); at != numbers.end();) {
            Forces forces{{at[0], at[1], static_cast<long>(at[2])}, {}, static_cast<std::int64_t>(at[3])};
            at += 4;
            for (std::size_t k = 0; k < walls; ++k, at += 3) forces.walls.emplace_back(at[0], at[1], at[2]);
            recent_.push_back(std::move(forces));
        }
    }

 private:
    std::deque<Forces> recent_;
};

struct Point {
    double strain, stress_true, stress_engineering, force_top, force_bottom, equilibrium_error, section;
};

Point measure(double strain, const PlaneForces& forces, double section, double initial_section) {
    Point point{};
    point.strain = strain;
    point.force_top = forces.top;
    // The sample pushes or pulls the two planes in opposite directions; with the sign of the axis they add up to zero.
    point.force_bottom = -forces.bottom;
    const double force = (forces.top + forces.bottom) / 2;
    const double magnitude = (std::abs(forces.top) + std::abs(forces.bottom)) / 2;
    point.section = section;
    point.stress_true = force / point.section;
    point.stress_engineering = force / initial_section;
    point.equilibrium_error = magnitude > 0 ? std::abs(point.force_top + point.force_bottom) / magnitude : 0;
    return point;
}

struct CurveValue {
    std::string name, unit;
    double value;
};

/// Everything that one point of the curves holds.
std::vector<CurveValue> curve_values(const Scene& scene, const Point& point, const std::vector<Vec3>& wall_forces,
                                     const plugin::Energies& energies) {
    std::vector<CurveValue> all{{"strain", "", point.strain}};
    if (!scene.steps.empty())
        all.insert(all.end(), {{"stress_true", "Pa", point.stress_true},
                               {"stress_engineering", "Pa", point.stress_engineering},
                               {"force_top", "uN", point.force_top},
                               {"force_bottom", "uN", point.force_bottom},
                               {"equilibrium_error", "", point.equilibrium_error},
                               {"section", "mm^2", point.section}});
    all.insert(all.end(), {{"kinetic_energy", "nJ", energies.kinetic}, {"potential_energy", "nJ", energies.seeds}});
    for (std::size_t k = 0; k < scene.walls.size(); ++k)
        for (int axis = 0; axis < 3; ++axis)
            all.push_back(
                {fmt::format("wall_{}_force_{}", scene.walls[k].name, "xyz"[axis]), "uN", wall_forces[k][axis]});
    return all;
}

const ParticleField velocity_field{"velocity", "mm s-1", 3};
const ParticleField stress_field{"stress", "Pa", 6};

/// A point of the curves, and what is done there.
struct PlannedPoint {
    std::size_t segment;
    std::int64_t from, to;  ///< steps of its segment
    double travelled;       ///< path in strain
    bool frame = false;     ///< written behind it
    bool sampled = false;   ///< stresses are, on the way to it
    bool rest = false;      ///< the solver is set up anew behind it
};

/// Everything that happens in a run, known beforehand: hence the same however often it is interrupted.
std::vector<PlannedPoint> plan_points(const Scene& scene, const std::vector<LoadSegment>& segments) {
    const double spacing = scene.averaging_strain / points_per_window;
    const double frame_spacing = scene.path_length() / static_cast<double>(scene.frames);
    std::vector<PlannedPoint> plan;
    double travelled = 0;
    std::int64_t frames = 0, since_rest = 0;
    for (std::size_t k = 0; k < segments.size(); ++k) {
        std::int64_t from = 0;
        double reached = segments[k].strain;
        for (const std::int64_t to : segments[k].curve_steps(spacing)) {
            const double strain = segments[k].strain_at(segments[k].time_step * static_cast<double>(to));
            travelled += std::abs(strain - reached);
            reached = strain;
            PlannedPoint point{k, from, to, travelled};
            if (travelled >= static_cast<double>(frames + 1) * frame_spacing * (1 - 1e-9)) {
                point.frame = true;
                frames = static_cast<std::int64_t>(travelled / frame_spacing * (1 + 1e-9));
            }
            since_rest += to - from;
            point.rest = since_rest >= steps_between_rests;
            if (point.rest) since_rest = 0;
            from = to;
            plan.push_back(point);
        }
    }
    for (std::size_t k = 0; scene.write_stress && k < plan.size(); ++k)
        for (std::size_t j = k; j < std::min(plan.size(), k + points_per_window); ++j)
            if (plan[j].frame) {
                plan[k].sampled = true;
                break;
            }
    return plan;
}

/// Where stresses are sampled among the steps to a point: anywhere in each of equal parts, since the particles swing in
/// step with each other, which equal distances would miss.
std::vector<std::int64_t> sample_steps(std::int64_t steps, std::size_t point) {
    const auto samples = std::min<std::int64_t>(samples_per_point, steps);
    std::vector<std::int64_t> result;
    for (std::int64_t k = 0; k < samples; ++k) {
        const std::int64_t from = steps * k / samples, length = steps * (k + 1) / samples - from;
        const double place = std::numbers::phi * static_cast<double>(samples * static_cast<std::int64_t>(point) + k);
        result.push_back(from + 1 +
                         static_cast<std::int64_t>((place - std::floor(place)) * static_cast<double>(length)));
    }
    return result;
}

std::filesystem::path with_suffix(std::filesystem::path file, const char* suffix) {
    std::error_code error;
    if (std::filesystem::is_symlink(file, error)) file = std::filesystem::weakly_canonical(file, error);
    return file += suffix;
}

Inputs inputs_of(const Provenance& provenance) {
    std::vector<std::string> digests;
    for (const auto& [name, digest] : provenance.inputs) digests.push_back(digest);
    std::sort(digests.begin(), digests.end());
    return {provenance.version, provenance.scene, fmt::format("{}", fmt::join(digests, " "))};
}

/// The planes must not jump over particles.
void check_plane_speed(const Scene& scene, const Model& model, const Packing& sample) {
    if (scene.steps.empty()) return;
    double low = 1e300, high = -1e300;
    for (const Vec3& point : sample.position) {
        low = std::min(low, point[scene.axis]);
        high = std::max(high, point[scene.axis]);
    }
    double highest_strain = 0;
    for (const LoadStep& step : scene.steps) highest_strain = std::max(highest_strain, step.strain);
    const double height = (high - low) * model.seed_radius / sample.seed_radius * std::exp(highest_strain);
    const double speed = 0.5 * scene.highest_rate() * height / model.crown_radius;
    const double way = speed * model.time_step;
    const std::string what = fmt::format(
        "the planes move by {:.2g} crown radii in one time step (critical regime: particles do not see them come)",
        way);
    if (way > plane_way_refused)
        throw InvalidInput(
            fmt::format("{}, at most {:g}; take a smaller time_step or strain_per_step", what, plane_way_refused));
    if (way > plane_way_warned) cli::warn(fmt::format("{}; better below {:g}", what, plane_way_warned));
    for (const PhaseModel& phase : model.phases)
        if (speed * phase.natural_period > plane_way_in_period_warned)
            cli::warn(fmt::format(
                "the planes move by {:.2g} crown radii in one natural period of label {} ({:.3g} s): "
                "its inertia carries the load; better below {:g}",
                speed * phase.natural_period, phase.label, phase.natural_period, plane_way_in_period_warned));
}

/// A run between its first and its last point.
class Pressing {
 public:
    Pressing(const Packing& sample, const Scene& scene, const std::filesystem::path& run_file,
             const Provenance& provenance, MPI_Comm communicator, const RunControl& control)
        : sample_(sample),
          scene_(scene),
          communicator_(communicator),
          control_(control),
          run_file_(run_file),
          partial_(with_suffix(run_file, ".partial")),
          checkpoint_file_(with_suffix(run_file, ".checkpoint")),
          inputs_(inputs_of(provenance)),
          first_(first_process(communicator)),
          meter_(communicator),
          watch_(communicator),
          model_(compile_model(scene, sample)),
          segments_(load_path(scene, model_.time_step)),
          plan_(plan_points(scene, segments_)) {
        if (run_file.extension() == ".xdmf")
            throw InvalidInput(fmt::format("cannot write '{}': name the HDF5 file (.h5), the .xdmf comes beside it",
                                           run_file.string()));
        check_plane_speed(scene, model_, sample);
        const Vec3 edges = sample.box.edges;
        initial_section_ = edges[(scene.axis + 1) % 3] * edges[(scene.axis + 2) % 3];
        if (scene.write_velocity) fields_.push_back(velocity_field);
        simulation_.emplace(sample, model_, scene.axis, communicator);
        if (scene.write_stress) {
            fields_.push_back(stress_field);
            fields_.back().attributes = {{"volume", simulation_->volume_per_particle()}};
        }
        std::error_code ignored;
        const bool go_on = control.resume && std::filesystem::exists(checkpoint_file_, ignored);
        MPI_Barrier(communicator);
        if (go_on)
            resume();
        else
            begin(provenance);
    }

    RunResult run() {
        try {
            std::optional<cli::Progress> progress;
            const double before = next_ > 0 ? plan_[next_ - 1].travelled : 0;
            progress.emplace("pressing", plan_.back().travelled - before);
            while (next_ < plan_.size()) {
                reach(plan_[next_]);
                progress->update(plan_[next_ - 1].travelled - before);
            }
        } catch (const Stopped& stop) {
            const std::string reason = fmt::format("stopped by {} {}", StopSignals::name(stop.signal), where());
            throw InvalidInput(reason + (rescue() ? fmt::format("; --resume goes on from the checkpoint '{}'",
                                                                checkpoint_file_.string())
                                                  : "; there is no checkpoint, nothing is kept"));
        } catch (const InvalidInput& error) {
            const std::string reason = error.what();
            throw InvalidInput(rescue() ? reason + kept_text() : reason);
        }
        return finish();
    }

 private:
    Simulation& simulation() { return *simulation_; }
    double time(std::int64_t step) const { return static_cast<double>(step) * model_.time_step; }
    /// Steps since the begin of the load.
    std::int64_t step() const { return simulation_->step() - start_; }
    std::int64_t segment_start(std::size_t segment) const {
        std::int64_t steps = start_;
        for (std::size_t k = 0; k < segment; ++k) steps += segments_[k].steps;
        return steps;
    }
    std::string where() const {
        return fmt::format("at strain {:.4f} (step {})", simulation_->strain(), simulation_->step());
    }

    void begin(const Provenance& provenance) {
        together(communicator_, [&] {
            if (!first_) return;
            std::error_code ignored;
            if (control_.resume)
                cli::note(
                    fmt::format("there is no checkpoint '{}': starting from the beginning", checkpoint_file_.string()));
            else if (std::filesystem::remove(checkpoint_file_, ignored))
                cli::note(fmt::format("starting anew: the checkpoint '{}' is removed (--resume goes on from one)",
                                      checkpoint_file_.string()));
            output_.emplace(run_file_, partial_);
        });
        try {
            const auto watch = watching(watch_, simulation());
            if (!sample_.relaxed) {
                cli::note("the sample is not relaxed yet: relaxing it first");
                relax_inside(simulation(), model_, sample_, default_relaxation_periods, watch);
                simulation().end_relaxation();
            }
            if (!scene_.steps.empty()) simulation().place_planes();
            place_walls(simulation(), scene_, Room::checked);
            if (model_.trilin) {
                relax_inside(simulation(), model_, sample_, seating_periods, watch);
                simulation().end_relaxation();
            }
        } catch (const Stopped& stop) {
            throw InvalidInput(fmt::format("stopped by {} while the sample was relaxed: nothing is kept",
                                           StopSignals::name(stop.signal)));
        }
        start_ = simulation().step();

        Packing pressed = sample_;
        pressed.box.periodic = {false, false, false};
        pressed.relaxed = true;
        RunShape shape;
        shape.frames = 1 + static_cast<std::size_t>(std::count_if(plan_.begin(), plan_.end(),
                                                                  [](const auto& point) { return point.frame; }));
        shape.fields = fields_;
        const std::vector<Vec3> no_wall_forces(scene_.walls.size(), Vec3::Zero());
        for (const CurveValue& curve : curve_values(scene_, {}, no_wall_forces, {}))
            shape.curves.push_back({curve.name, curve.unit, plan_.size() + 1});
        together(communicator_, [&] {
            if (first_) create_run_file(pressed, shape, provenance, partial_, run_file_);
        });
        open();
        simulation().run(0);
        const plugin::Energies energies = simulation().energies();
        refuse_collapse(simulation(), energies.seeds, model_, sample_, "at the start");
        write_frame();
        write_point(0, measure(0, {}, initial_section_, initial_section_), no_wall_forces, energies);
        take_snapshot();
    }

    void resume() {
        const FoundCheckpoint found = read_checkpoint(checkpoint_file_, inputs_, communicator_);
        const Checkpoint& checkpoint = found.checkpoint;
        together(communicator_, [&] {
            if (!std::filesystem::exists(partial_))
                throw InvalidInput(
                    fmt::format("cannot go on from '{}': the frames and curves before it, '{}', are not there; start "
                                "anew without --resume",
                                checkpoint_file_.string(), partial_.string()));
            if (!first_) return;
            output_.emplace(run_file_, partial_);
            output_->keep();
        });
        kept_ = true;
        simulation().restore(found);
        place_walls(simulation(), scene_, Room::taken);
        next_ = static_cast<std::size_t>(checkpoint.number("next_point"));
        start_ = static_cast<std::int64_t>(checkpoint.number("first_step"));
        frames_ = static_cast<std::size_t>(checkpoint.number("frames"));
        error_sum_ = checkpoint.number("error_sum");
        error_points_ = static_cast<std::int64_t>(checkpoint.number("error_points"));
        samples_ = static_cast<std::int64_t>(checkpoint.number("samples"));
        last_stress_ = checkpoint.number("last_stress");
        last_strain_ = checkpoint.number("last_strain");
        window_.restore(checkpoint.numbers.at("window"), scene_.walls.size());
        meter_.carry(checkpoint.number("wall_seconds"), checkpoint.number("cpu_seconds"));
        sums_ = checkpoint.sums;
        if (next_ < plan_.size() && plan_[next_].from > 0) {
            const std::size_t segment = plan_[next_].segment;
            simulation().continue_loading(segments_[segment], segment_start(segment));
        }
        open();
        cli::note(fmt::format("going on {}{}", where(),
                              found.same_processes ? ""
                                                   : "; on another number of processes the result is the same in the "
                                                     "mean only"));
        take_snapshot();
        snapshot_on_disk_ = true;
    }

    void open() {
        together(communicator_, [&] { file_.emplace(partial_, run_file_, communicator_); });
        last_checkpoint_ = std::chrono::steady_clock::now();
    }

    /// Runs to a point, and does what is due there.
    void reach(const PlannedPoint& point) {
        if (point.from == 0) simulation().set_loading(segments_[point.segment]);
        const auto pieces = watching(watch_, simulation());
        const std::int64_t steps = point.to - point.from;
        if (point.sampled) {
            std::int64_t done = 0;
            for (const std::int64_t at : sample_steps(steps, next_)) {
                simulation().run_to_stress_sample(at - done, pieces);
                add_sample();
                done = at;
            }
            simulation().run(steps - done, pieces);
        } else {
            simulation().run(steps, pieces);
        }
        const plugin::Energies energies = simulation().energies();
        refuse_runaway(simulation(), energies.kinetic, model_, sample_,
                       fmt::format("at strain {:.3f}", simulation().strain()));
        refuse_collapse(simulation(), energies.seeds, model_, sample_,
                        fmt::format("at strain {:.3f}", simulation().strain()));
        window_.add({simulation().take_forces(), simulation().take_wall_forces(), steps});
        const Forces forces = window_.mean();
        const double strain = simulation().strain();
        const double section = simulation().periodic_section().value_or(initial_section_ * std::exp(-strain));
        const Point measured = measure(strain, forces.planes, section, initial_section_);
        ++next_;
        write_point(next_, measured, forces.walls, energies);
        if (point.travelled > scene_.path_length() / 2) {
            error_sum_ += measured.equilibrium_error;
            ++error_points_;
        }
        last_stress_ = measured.stress_true;
        last_strain_ = measured.strain;
        if (point.frame) write_frame();
        if (point.rest) {
            take_snapshot();
            if (is_due()) write_snapshot();
        }
    }

    void add_sample() {
        const RowBlock sample = simulation().stress_rows();
        if (samples_++ == 0) sums_ = {sample.first, sample.components, {}};
        sums_.values.resize(sample.values.size());
        for (std::size_t k = 0; k < sample.values.size(); ++k) sums_.values[k] += sample.values[k];
    }

    void write_frame() {
        const RowBlock positions = simulation().position_rows();
        together(communicator_, [&] {
            for (const double x : positions.values)
                if (!std::isfinite(x))
                    throw InvalidInput(fmt::format("the position of a particle is not a finite number {}", where()));
        });
        const auto write = [&](const ParticleField& field, const RowBlock& block) {
            together(communicator_, [&] { file_->write_rows(field, frames_, block.first, block.values); });
        };
        write(position_field, positions);
        if (scene_.write_velocity) write(velocity_field, simulation().velocity_rows());
        if (scene_.write_stress) {
            if (samples_ == 0) {  // at rest: no rates, from which the laws tell attraction from none
                sums_ = {positions.first, stress_field.components, {}};
                sums_.values.assign(2 * positions.values.size(), std::numeric_limits<double>::quiet_NaN());
            } else {
                for (double& sum : sums_.values) sum /= static_cast<double>(samples_);
            }
            write(stress_field, sums_);
            samples_ = 0;
            sums_ = {};
        }
        together(communicator_, [&] {
            if (first_) file_->mark_frame(frames_, step(), time(step()));
        });
        ++frames_;
    }

    void write_point(std::size_t index, const Point& point, const std::vector<Vec3>& wall_forces,
                     const plugin::Energies& energies) {
        together(communicator_, [&] {
            if (!first_) return;
            for (const CurveValue& curve : curve_values(scene_, point, wall_forces, energies))
                file_->write_point(curve.name, index, step(), time(step()), curve.value);
        });
    }

    /// The moment that a resumed run goes on from: this one, too, goes on as if it were resumed.
    void take_snapshot() {
        simulation().rest();
        if (control_.checkpoint_minutes <= 0) return;
        simulation().save(snapshot_);
        const Cost cost = meter_.cost(0, 0);
        const auto keep = [&](const char* name, double number) { snapshot_.numbers[name] = {number}; };
        keep("next_point", static_cast<double>(next_));
        keep("first_step", static_cast<double>(start_));
        keep("frames", static_cast<double>(frames_));
        keep("error_sum", error_sum_);
        keep("error_points", static_cast<double>(error_points_));
        keep("samples", static_cast<double>(samples_));
        keep("last_stress", last_stress_);
        keep("last_strain", last_strain_);
        keep("wall_seconds", cost.wall_seconds);
        keep("cpu_seconds", cost.cpu_seconds);
        snapshot_.numbers["window"] = window_.numbers();
        snapshot_.sums = sums_;
        snapshot_taken_ = true;
        snapshot_on_disk_ = false;
    }

    bool is_due() const {
        if (control_.checkpoint_minutes <= 0) return false;
        const double minutes =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - last_checkpoint_).count() / 60;
        int due = minutes >= control_.checkpoint_minutes;
        MPI_Bcast(&due, 1, MPI_INT, 0, communicator_);
        return due != 0;
    }

    void write_snapshot() {
        together(communicator_, [&] {
            if (first_) output_->flush();  // the checkpoint counts on the frames and points before it
        });
        write_checkpoint(snapshot_, inputs_, checkpoint_file_, communicator_);
        if (first_) output_->keep();
        kept_ = snapshot_on_disk_ = true;
        simulation().advise(kept_text());
        last_checkpoint_ = std::chrono::steady_clock::now();
    }

    /// Saves the last snapshot before the run ends too early. @return whether there is a checkpoint
    bool rescue() {
        try {
            if (snapshot_taken_ && !snapshot_on_disk_) write_snapshot();
        } catch (const InvalidInput&) {
            // What ended the run is what the user must hear.
        }
        return kept_;
    }

    std::string kept_text() const {
        return fmt::format("; the last checkpoint before it is '{}', frames and curves are in '{}'",
                           checkpoint_file_.string(), partial_.string());
    }

    RunResult finish() {
        RunResult result;
        result.time_step = model_.time_step;
        result.particles = static_cast<std::int64_t>(sample_.size());
        result.final_strain = last_strain_;
        result.final_stress = last_stress_;
        result.mean_equilibrium_error = error_points_ > 0 ? error_sum_ / static_cast<double>(error_points_) : 0;
        result.particles_lost = result.particles - simulation().particles();
        result.cost = meter_.cost(simulation().step(), simulation().neighbour_builds());
        together(communicator_, [&] { file_->close(); });
        together(communicator_, [&] {
            if (!first_) return;
            std::vector<double> times{0};
            for (const PlannedPoint& point : plan_)
                if (point.frame) times.push_back(time(segment_start(point.segment) - start_ + point.to));
            remove_sidecar(run_file_);
            output_->commit();
            write_sidecar(sample_, times, run_file_);
            std::error_code ignored;
            std::filesystem::remove(checkpoint_file_, ignored);
        });
        return result;
    }

    const Packing& sample_;
    const Scene& scene_;
    MPI_Comm communicator_;
    RunControl control_;
    std::filesystem::path run_file_, partial_, checkpoint_file_;
    Inputs inputs_;
    bool first_;
    StopSignals signals_;
    Meter meter_;
    Watch watch_;
    Model model_;
    std::vector<LoadSegment> segments_;
    std::vector<PlannedPoint> plan_;
    std::vector<ParticleField> fields_;
    double initial_section_ = 0;
    std::optional<OutputFile> output_;  // on the first process
    std::optional<RunFile> file_;
    std::optional<Simulation> simulation_;

    std::size_t next_ = 0;  ///< point of the plan
    std::int64_t start_ = 0;
    std::size_t frames_ = 0;
    ForceWindow window_;
    double error_sum_ = 0, last_stress_ = 0, last_strain_ = 0;
    std::int64_t error_points_ = 0, samples_ = 0;
    RowBlock sums_;

    Checkpoint snapshot_;
    bool snapshot_taken_ = false, snapshot_on_disk_ = false;
    bool kept_ = false;  ///< there is a checkpoint on the disk
    std::chrono::steady_clock::time_point last_checkpoint_;
};

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
    for (int axis = 0; axis < 3; ++axis)
        result.sample.box.periodic[axis] = model.lateral != Lateral::free && axis != scene.axis;
    result.sample.relaxed = true;
    for (std::size_t k = 0; k < result.sample.position.size(); ++k)
        result.largest_displacement = std::max(
            result.largest_displacement, (result.sample.position[k] - sample.position[k]).norm() / sample.seed_radius);
    result.cost = meter.cost(simulation.step(), simulation.neighbour_builds());
    return result;
}

RunResult solve(const Packing& sample, const Scene& scene, const std::filesystem::path& run_file,
                const Provenance& provenance, MPI_Comm communicator, const RunControl& control) {
    return Pressing(sample, scene, run_file, provenance, communicator, control).run();
}

bool is_complete(const std::filesystem::path& run_file, const Provenance& provenance) {
    std::error_code ignored;
    if (!std::filesystem::exists(run_file, ignored)) return false;
    try {
        const Inputs mine = inputs_of(provenance), its = inputs_of(RunReader(run_file).provenance());
        return mine.version == its.version && mine.scene == its.scene && mine.digests == its.digests;
    } catch (const InvalidInput&) {
        return false;
    }
}

}  // namespace tomodem
