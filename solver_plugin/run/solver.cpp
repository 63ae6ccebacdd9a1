#include "solver_plugin/run/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/packing/packing_file.hpp"
#include "core/packing/run_file.hpp"
#include "core/scene/load_path.hpp"
#include "solver_plugin/run/continuation.hpp"
#include "solver_plugin/run/forewarnings.hpp"
#include "solver_plugin/run/guards.hpp"
#include "solver_plugin/run/meter.hpp"
#include "solver_plugin/run/relaxation.hpp"
#include "solver_plugin/run/run_curves.hpp"
#include "solver_plugin/run/run_plan.hpp"
#include "solver_plugin/run/scene_walls.hpp"
#include "solver_plugin/run/stop_signals.hpp"
#include "solver_plugin/simulation/checkpoint.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem {
namespace {

using plugin::relax_inside;
using plugin::rest_inside;
using plugin::Simulation;
using plugin::Stopped;
using plugin::Watch;
using plugin::watching;

/// Of pressing, before the time of the whole run is predicted.
constexpr double seconds_to_predict_from = 2;

bool first_process(MPI_Comm communicator) {
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    return rank == 0;
}

const ParticleField velocity_field{"velocity", "mm s-1", 3};
const ParticleField outward_field{"outward", "mm", 3};
const ParticleField stress_field{"stress", "Pa", 6};

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

/// A run between its first and its last point.
class Pressing {
 public:
    Pressing(Packing sample, Continuation* before, const Scene& scene, const std::filesystem::path& run_file,
             const Provenance& provenance, MPI_Comm communicator, const RunControl& control, Reporter& reporter)
        : sample_(std::move(sample)),
          before_(before),
          scene_(scene),
          communicator_(communicator),
          control_(control),
          reporter_(reporter),
          run_file_(run_file),
          partial_(with_suffix(run_file, ".partial")),
          checkpoint_file_(with_suffix(run_file, ".checkpoint")),
          inputs_(inputs_of(provenance)),
          first_(first_process(communicator)),
          meter_(communicator),
          watch_(communicator),
          model_(model_of(scene, *sample_, before_)),
          begin_(before_ ? before_->begin(scene) : LoadBegin{}),
          segments_(load_path(scene, model_, begin_)),
          clocks_(clocks_of(segments_)),
          plan_(plan_points(scene, segments_)),
          window_(window_points(scene)) {
        if (run_file.extension() == ".xdmf")
            throw InvalidInput(fmt::format("cannot write '{}': name the HDF5 file (.h5), the .xdmf comes beside it",
                                           run_file.string()));
        std::error_code ignored;
        const bool go_on = control.resume && std::filesystem::exists(checkpoint_file_, ignored);
        if (!go_on) forewarn(scene, *sample_, model_, before_, reporter);
        has_objects_ = !sample_->object.empty();
        const Vec3 edges = sample_->box.edges;
        initial_section_ = edges[(scene.axis + 1) % 3] * edges[(scene.axis + 2) % 3];
        filled_volume_ = sample_->box.volume();
        if (before_) total_strain_ = before_->end.total_strain;
        if (scene.write_velocity) fields_.push_back(velocity_field);
        if (scene.self_contact) fields_.push_back(outward_field);
        simulation_.emplace(*sample_, model_, scene.axis, communicator);
        if (scene.write_stress) {
            fields_.push_back(stress_field);
            fields_.back().attributes = {{"volume", simulation_->volume_per_particle()}};
        }
        MPI_Barrier(communicator);
        if (go_on)
            resume();
        else
            begin(provenance);
    }

    RunResult run() {
        try {
            const double before = next_ > 0 ? plan_[next_ - 1].travelled : 0;
            const auto progress = reporter_.progress("pressing", plan_.back().travelled - before);
            const auto begun = std::chrono::steady_clock::now();
            const std::int64_t first_step = step(), first_evaluation = evaluations_;
            while (next_ < plan_.size()) {
                reach(plan_[next_]);
                if (predicted_wall_ == 0) predict(begun, first_step, first_evaluation);
                progress->update(plan_[next_ - 1].travelled - before);
            }
        } catch (const Stopped& stop) {
            const std::string reason = fmt::format("stopped by {} {}", StopSignals::name(stop.signal), where());
            throw InvalidInput(reason + (rescue() ? fmt::format("; --resume continues from the checkpoint '{}'",
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
    /// Of the load at a point [s].
    double time_at(const PlannedPoint& point) const {
        return clocks_[point.segment].at(segment_start(point.segment) - start_ + point.to);
    }
    /// At the last point reached.
    double time() const { return next_ > 0 ? time_at(plan_[next_ - 1]) : 0; }
    /// Steps since the begin of the load.
    std::int64_t step() const { return simulation_->step() - start_; }
    std::int64_t segment_start(std::size_t segment) const {
        std::int64_t steps = start_;
        for (std::size_t k = 0; k < segment; ++k) steps += segments_[k].steps;
        return steps;
    }
    std::string where() const { return fmt::format("at strain {:.4f} (step {})", strain(), simulation_->step()); }
    /// Since the begin of the load.
    double strain() const { return simulation_->strain() - begin_.strain; }

    void begin(const Provenance& provenance) {
        together(communicator_, [&] {
            if (!first_) return;
            std::error_code ignored;
            if (control_.resume)
                reporter_.note(
                    fmt::format("there is no checkpoint '{}': starting from the beginning", checkpoint_file_.string()));
            else if (std::filesystem::remove(checkpoint_file_, ignored))
                reporter_.note(
                    fmt::format("starting again: the checkpoint '{}' is removed (--resume continues from one)",
                                checkpoint_file_.string()));
            output_.emplace(run_file_, partial_);
        });
        if (before_)
            continue_before();
        else
            rest_first();
        find_section();
        start_ = simulation().step();

        sample_->box.periodic = {false, false, false};
        sample_->relaxed = true;
        RunShape shape;
        shape.frames = 1 + static_cast<std::size_t>(std::count_if(plan_.begin(), plan_.end(),
                                                                  [](const auto& point) { return point.frame; }));
        shape.fields = fields_;
        const std::vector<Vec3> no_wall_forces(scene_.walls.size(), Vec3::Zero());
        for (const CurveValue& curve : curve_values(scene_, {}, no_wall_forces, {}, 0))
            shape.curves.push_back({curve.name, curve.unit, plan_.size() + 1});
        together(communicator_, [&] {
            if (first_) create_run_file(*sample_, shape, provenance, partial_, run_file_);
        });
        sample_.reset();
        open();
        plugin::Energies energies;
        Forces forces{{}, no_wall_forces, 0};
        if (before_) {
            energies = {before_->end.kinetic_energy, before_->end.potential_energy};
            if (window_.filled()) forces = window_.mean();
        } else {
            simulation().run(0);
            energies = simulation().energies();
            refuse_collapse(simulation(), energies.seeds, model_, "at the start");
        }
        write_frame();
        write_point(0, measure(0, forces.planes, initial_section_, initial_section_), forces.walls, energies, 0);
        take_snapshot();
    }

    /// The faces are where the planes found enough to hold. A load that goes on from another has its section.
    void find_section() {
        if (model_.law->traits().measures_by_volume && model_.lateral == Lateral::free && !scene_.steps.empty() &&
            !before_)
            initial_section_ = filled_volume_ / simulation().initial_height();
    }

    /// Of a sample, and between planes that pull.
    void rest_first() {
        try {
            const auto watch = watching(watch_, simulation());
            if (!sample_->relaxed) {
                relax_inside(simulation(), model_, {}, watch, reporter_);
                simulation().end_relaxation();
            }
            if (!scene_.steps.empty()) simulation().place_planes();
            place_walls(simulation(), scene_, WallsInside::refused);
            if (model_.law->traits().planes_pull) {
                rest_inside(simulation(), model_, seating_periods, watch, reporter_);
                simulation().end_relaxation();
            }
        } catch (const Stopped& stop) {
            throw InvalidInput(fmt::format("stopped by {} while the sample was relaxed: nothing is kept",
                                           StopSignals::name(stop.signal)));
        }
    }

    /// From the end of the run before.
    void continue_before() {
        prepare(*before_, scene_, model_);
        simulation().restore(before_->state);
        before_->state.checkpoint.particles = {};  // the simulation has them
        steps_before_ = simulation().step();
        if (!scene_.steps.empty()) {
            if (before_->has_planes())
                hold();
            else
                simulation().place_planes();
        }
        place_walls(simulation(), scene_, WallsInside::refused);
        // Walls have other forces than before; the planes' go on.
        if (before_->has_planes() && scene_.walls.empty() && before_->scene.walls.empty())
            window_.restore(before_->end.window, 0);
    }

    /// The last rate of the run before is that of the present segment until the load begins.
    void hold() {
        simulation().continue_loading(
            {.strain = begin_.strain, .rate = {begin_.rate}, .time_step = before_->end.time_step}, simulation().step());
    }

    void resume() {
        const FoundCheckpoint found = read_checkpoint(checkpoint_file_, inputs_, communicator_);
        const Checkpoint& checkpoint = found.checkpoint;
        together(communicator_, [&] {
            if (!std::filesystem::exists(partial_))
                throw InvalidInput(
                    fmt::format("cannot resume from '{}': the frames and curves before it, '{}', are not there; start "
                                "anew without --resume",
                                checkpoint_file_.string(), partial_.string()));
            if (!first_) return;
            output_.emplace(run_file_, partial_);
            output_->keep();
        });
        kept_ = true;
        sample_.reset();
        simulation().restore(found);
        place_walls(simulation(), scene_, WallsInside::allowed);
        find_section();
        next_ = static_cast<std::size_t>(checkpoint.number("next_point"));
        start_ = static_cast<std::int64_t>(checkpoint.number("first_step"));
        steps_before_ = static_cast<std::int64_t>(checkpoint.number("steps_before"));
        frames_ = static_cast<std::size_t>(checkpoint.number("frames"));
        error_sum_ = checkpoint.number("error_sum");
        error_points_ = static_cast<std::int64_t>(checkpoint.number("error_points"));
        samples_ = static_cast<std::int64_t>(checkpoint.number("samples"));
        evaluations_ = static_cast<std::int64_t>(checkpoint.number("evaluations"));
        last_stress_ = checkpoint.number("last_stress");
        last_strain_ = checkpoint.number("last_strain");
        last_section_ = checkpoint.number("last_section");
        last_energies_ = {checkpoint.number("last_kinetic_energy"), checkpoint.number("last_potential_energy")};
        window_.restore(checkpoint.numbers.at("window"), scene_.walls.size());
        meter_.carry(checkpoint.number("wall_seconds"), checkpoint.number("cpu_seconds"));
        sums_ = checkpoint.sums;
        if (next_ > 0) {  // the segment that the last point is in, to its end
            const std::size_t segment = plan_[next_ - 1].segment;
            simulation().continue_loading(segments_[segment], segment_start(segment));
        } else if (before_ && before_->has_planes() && !scene_.steps.empty()) {
            hold();
        }
        open();
        reporter_.note(fmt::format("resuming {}{}", where(),
                                   found.same_processes
                                       ? ""
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
        const std::int64_t evaluations_before = simulation().evaluations();
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
        refuse_runaway(simulation(), energies.kinetic, model_, fmt::format("at strain {:.3f}", strain()));
        refuse_collapse(simulation(), energies.seeds, model_, fmt::format("at strain {:.3f}", strain()));
        refuse_heat(simulation(), energies.kinetic, model_, fmt::format("at strain {:.3f}", strain()));
        window_.add({simulation().take_forces(), simulation().take_wall_forces(), steps});
        const Forces forces = window_.mean();
        const double section = simulation().periodic_section().value_or(initial_section_ * std::exp(-strain()));
        Point measured = measure(strain(), forces.planes, section, initial_section_);
        if (!scene_.steps.empty() && model_.law->traits().measures_by_volume)
            measured.stress_virial = simulation().axial_virial() /
                                     (section * simulation().initial_height() * std::exp(simulation().strain()));
        const std::int64_t evaluations = simulation().evaluations() - evaluations_before;
        evaluations_ += evaluations;
        ++next_;
        write_point(next_, measured, forces.walls, energies, evaluations);
        if (point.travelled > scene_.path_length() / 2) {
            error_sum_ += measured.equilibrium_error;
            ++error_points_;
        }
        last_stress_ = measured.stress_true;
        last_strain_ = measured.strain;
        last_section_ = measured.section;
        last_energies_ = energies;
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
        if (scene_.self_contact) write(outward_field, simulation().outward_rows());
        if (scene_.write_stress) {
            if (samples_ == 0) {  // at rest: no rates, without which the laws have no attraction
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
            if (first_) file_->mark_frame(frames_, step(), time());
        });
        ++frames_;
    }

    void write_point(std::size_t index, const Point& point, const std::vector<Vec3>& wall_forces,
                     const plugin::Energies& energies, std::int64_t evaluations) {
        together(communicator_, [&] {
            if (!first_) return;
            for (const CurveValue& curve : curve_values(scene_, point, wall_forces, energies, evaluations))
                file_->write_point(curve.name, index, step(), time(), curve.value);
        });
    }

    /// The moment that a resumed run starts from: this run, too, continues as if it were resumed.
    void take_snapshot() {
        simulation().rest();
        if (control_.checkpoint_minutes <= 0) return;
        simulation().save(snapshot_);
        const Cost cost = meter_.cost(0, 0);
        const auto keep = [&](const char* name, double number) { snapshot_.numbers[name] = {number}; };
        keep("next_point", static_cast<double>(next_));
        keep("first_step", static_cast<double>(start_));
        keep("steps_before", static_cast<double>(steps_before_));
        keep("frames", static_cast<double>(frames_));
        keep("error_sum", error_sum_);
        keep("error_points", static_cast<double>(error_points_));
        keep("samples", static_cast<double>(samples_));
        keep("evaluations", static_cast<double>(evaluations_));
        keep("last_stress", last_stress_);
        keep("last_strain", last_strain_);
        keep("last_section", last_section_);
        keep("last_kinetic_energy", last_energies_.kinetic);
        keep("last_potential_energy", last_energies_.seeds);
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

    /// Total wall time, once there are some seconds of pressing to judge from.
    /// Quasi-static steps are counted by their evaluations: the first take many more than the others.
    void predict(std::chrono::steady_clock::time_point begun, std::int64_t first_step, std::int64_t first_evaluation) {
        double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        MPI_Bcast(&seconds, 1, MPI_DOUBLE, 0, communicator_);  // or some processes would predict, and others not yet
        if (seconds < seconds_to_predict_from) return;
        const std::int64_t all = segment_start(segments_.size()) - start_;
        const auto evaluations = [&](std::int64_t steps) {
            return model_.law->evaluations(model_, static_cast<double>(steps));
        };
        const std::int64_t done =
            model_.scheme == Scheme::quasi_static ? evaluations_ - first_evaluation : step() - first_step;
        predicted_wall_ = meter_.cost(0, 0).wall_seconds +
                          seconds / static_cast<double>(done) * (evaluations(all) - evaluations(step()));
    }

    RunResult finish() {
        RunResult result;
        result.predicted_wall_seconds = predicted_wall_;
        result.time_step = model_.time_step;
        result.particles = simulation().initial_particles();
        result.final_strain = last_strain_;
        result.final_stress = last_stress_;
        result.mean_equilibrium_error = error_points_ > 0 ? error_sum_ / static_cast<double>(error_points_) : 0;
        result.particles_lost = result.particles - simulation().particles();
        result.cost = meter_.cost(simulation().step() - steps_before_, simulation().neighbour_builds());
        result.cost.evaluations = evaluations_;
        together(communicator_, [&] { file_->close(); });
        write_end();
        together(communicator_, [&] {
            if (!first_) return;
            std::vector<double> times{0};
            for (const PlannedPoint& point : plan_)
                if (point.frame) times.push_back(time_at(point));
            remove_sidecar(run_file_);
            output_->commit();
            write_sidecar(static_cast<std::size_t>(simulation().initial_particles()), has_objects_, times, fields_,
                          run_file_);
            std::error_code ignored;
            std::filesystem::remove(checkpoint_file_, ignored);
        });
        return result;
    }

    /// What another load continues from.
    void write_end() {
        simulation().rest();
        snapshot_ = {};  // no more of use
        Checkpoint end;
        simulation().save(end);
        const bool planes = !scene_.steps.empty();
        const LoadSegment& last = segments_.back();
        EndOfRun{.strain = planes ? begin_.strain + scene_.steps.back().strain : 0,
                 .total_strain = total_strain_ + (planes ? scene_.steps.back().strain : 0),
                 .rate = planes ? last.rate_at(last.time_step * static_cast<double>(last.steps)) : 0,
                 .time_step = last.time_step,
                 .height = model_.height,
                 .section = planes ? last_section_ : initial_section_,
                 .kinetic_energy = last_energies_.kinetic,
                 .potential_energy = last_energies_.seeds,
                 .window = window_.numbers()}
            .save(end);
        write_end_state(end, partial_, run_file_, communicator_);
    }

    std::optional<Packing> sample_;  ///< until the simulation and the run file have it
    Continuation* before_;           ///< null: the run begins with a sample
    bool has_objects_ = false;
    const Scene& scene_;
    MPI_Comm communicator_;
    RunControl control_;
    Reporter& reporter_;
    std::filesystem::path run_file_, partial_, checkpoint_file_;
    Inputs inputs_;
    bool first_;
    StopSignals signals_;
    Meter meter_;
    Watch watch_;
    Model model_;
    LoadBegin begin_;
    std::vector<LoadSegment> segments_;
    std::vector<LoadClock> clocks_;  ///< of the segments, from the begin of the load
    std::vector<PlannedPoint> plan_;
    ForceWindow window_;
    std::vector<ParticleField> fields_;
    double initial_section_ = 0, filled_volume_ = 0;
    std::optional<OutputFile> output_;  // on the first process
    std::optional<RunFile> file_;
    std::optional<Simulation> simulation_;

    std::size_t next_ = 0;  ///< point of the plan
    std::int64_t start_ = 0;
    std::int64_t steps_before_ = 0;  ///< of the run that this one continues
    std::size_t frames_ = 0;
    double predicted_wall_ = 0;
    double error_sum_ = 0, last_stress_ = 0, last_strain_ = 0, last_section_ = 0;
    plugin::Energies last_energies_;
    double total_strain_ = 0;  ///< before this run
    std::int64_t error_points_ = 0, samples_ = 0;
    std::int64_t evaluations_ = 0;  ///< of the load, quasi-static
    RowBlock sums_;

    Checkpoint snapshot_;
    bool snapshot_taken_ = false, snapshot_on_disk_ = false;
    bool kept_ = false;  ///< there is a checkpoint on the disk
    std::chrono::steady_clock::time_point last_checkpoint_;
};

}  // namespace

RunResult solve(Packing sample, const Scene& scene, const std::filesystem::path& run_file, const Provenance& provenance,
                MPI_Comm communicator, const RunControl& control, Reporter& reporter, Continuation* before) {
    return Pressing(std::move(sample), before, scene, run_file, provenance, communicator, control, reporter).run();
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
