// solve: press a sample as a scene says, on LIGGGHTS, and write its frames and curves.
#include "solver_plugin/run/solver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "core/scene/expected_flow.hpp"
#include "solver_plugin/run/continuation.hpp"
#include "solver_plugin/run/explain.hpp"
#include "solver_plugin/run/mpi_session.hpp"

namespace {

using namespace tomodem;

struct Request {
    std::filesystem::path sample, scene, run;
    std::string frame;
    RunControl control;
    bool explain = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage("solve", "Deform a sample of particles as a scene says, and write frames and curves.")
        .input("SAMPLE", request.sample,
               "Sample of particles (.h5), relaxed first if that was not done before; with --frame last, a run.")
        .input("SCENE", request.scene, "What the sample is made of and how it is loaded (.toml, docs/scene.md).")
        .output("RUN", request.run, "Frames and curves to write.", {".h5"})
        .option(
            "--frame", request.frame,
            "With `last`, SAMPLE is a run, and the new load continues from its end (docs/running.md). Strain and time "
            "count from there.")
        .flag("--resume", request.control.resume,
              "Resume an interrupted run from its RUN.checkpoint. If there is none, the run starts from the beginning.")
        .option("--checkpoint-every", request.control.checkpoint_minutes, cli::Unit::none, cli::not_negative,
                "Minutes of wall time between two checkpoints; 0 writes none.")
        .flag("--explain", request.explain,
              "Check the scene, and print what it switches on, the number of time steps, and the time and memory that "
              "they will take, measured for two seconds on this machine. RUN is not written.")
        .step(cli::Step::run)
        .example("solve relaxed.h5 scene.toml run.h5")
        .example("solve relaxed.h5 scene.toml run.h5 --explain")
        .example("solve relaxed.h5 scene.toml run.h5 --resume")
        .example("solve run.h5 --frame last next_load.toml next.h5")
        .example("mpirun -np 2 solve relaxed.h5 scene.toml run.h5 --json run.json");
}

/// What the calibration promises of each phase that is given by norton.
void report(const Scene& scene, const std::vector<ExpectedFlow>& flows, cli::Tool& tool) {
    if (flows.empty()) return;
    tool.report("calibration", scene.calibration ? scene.flow_table().name : "shipped, " + scene.flow_table().name);
    auto rows = nlohmann::ordered_json::array();
    for (const ExpectedFlow& one : flows) {
        tool.report(
            "expected_flow_" + one.phase,
            fmt::format("{:.4g} MPa within {:.0f} % (packings {:.1f}, rates {:.1f}, size {:.1f}, time step {:.1f}), "
                        "{:.3g} to {:.3g} /s, strain {:g} to {:g}{}",
                        one.stress / 1e6, 100 * one.error, 100 * one.packings, 100 * one.rates, 100 * one.size,
                        100 * one.time_step, one.rate[0], one.rate[1], one.strain[0], one.strain[1],
                        one.outside.empty() ? "" : "; this scene is outside"));
        rows.push_back({{"phase", one.phase},
                        {"label", one.label},
                        {"stress", one.stress},
                        {"error", one.error},
                        {"error_packings", one.packings},
                        {"error_rates", one.rates},
                        {"error_size", one.size},
                        {"error_time_step", one.time_step},
                        {"rate_from", one.rate[0]},
                        {"rate_to", one.rate[1]},
                        {"strain_from", one.strain[0]},
                        {"strain_to", one.strain[1]},
                        {"outside", one.outside}});
    }
    tool.report_json("expected_flow", rows);
}

void report(const Explanation& found, cli::Tool& tool) {
    for (const Ingredient& one : found.ingredients)
        tool.report(one.name, fmt::format("{}: {}", one.on ? "on" : "off", one.why));
    tool.report("particles", found.particles);
    tool.report("processes", static_cast<std::int64_t>(found.processes));
    tool.report("time_step", found.time_step, "s");
    tool.report("time_step_reason", found.time_step_reason);
    tool.report("steps", found.steps);
    if (found.evaluations > 0) tool.report("evaluations", found.evaluations);
    tool.report("seconds_per_particle_step", found.seconds_per_particle_step, "s");
    tool.report("predicted_wall_seconds", found.wall_seconds, "s");
    tool.report("predicted_peak_bytes", found.peak_bytes, "B");
}

Continuation end_of_run(const Request& request, const Scene& scene) {
    Continuation before = read_continuation(request.sample, MPI_COMM_WORLD);
    if (request.frame != "last" && request.frame != std::to_string(before.last_frame))
        throw InvalidInput(
            fmt::format("--frame {}: a load continues from the last frame of a run (--frame last); of those before it, "
                        "the velocities and what the contacts remember are not kept",
                        request.frame));
    check_continuation(before, scene);
    return before;
}

void run(const Request& request, cli::Tool& tool) {
    const Scene scene = read_scene(request.scene);
    std::optional<Continuation> before;
    if (!request.frame.empty()) before = end_of_run(request, scene);
    Packing sample = before ? std::move(before->sample) : read_sample(request.sample);
    check_names(scene, sample);
    std::vector<std::string> changed = before ? changes(before->scene, scene) : std::vector<std::string>{};
    if (!before && sample.relaxed)
        changed = check_rest(sample, RunReader(request.sample).provenance().scene, scene, tool);
    if (request.explain) {
        const Explanation found = explain(sample, scene, before ? &*before : nullptr, MPI_COMM_WORLD, tool);
        report(found, tool);
        report(scene, found.flows, tool);
        return;
    }
    Provenance provenance = tool.provenance();
    provenance.scene = scene.text;
    for (const Wall& wall : scene.walls)  // one that does not exist is refused later, with its line
        if (std::filesystem::exists(wall.surface))
            provenance.inputs[wall.surface.string()] = content_digest(wall.surface);
    if (!scene.calibration_file.empty())
        provenance.inputs[scene.calibration_file.string()] = content_digest(scene.calibration_file);
    if (before) {
        provenance.strain_before = before->end.total_strain;
        provenance.time_before = before->time();
    }
    if (request.control.resume && is_complete(request.run, provenance)) {
        tool.note(fmt::format("'{}' is complete: nothing to do", request.run.string()));
        return;
    }
    const std::vector<ExpectedFlow> flows = expected_flows(scene, static_cast<std::int64_t>(sample.size()),
                                                           model_of(scene, sample, before ? &*before : nullptr));
    report(scene, flows, tool);
    if (before) {
        tool.report("strain_before", *provenance.strain_before);
        tool.report("time_before", *provenance.time_before, "s");
        tool.report_json("changed_since_run", changed);
    } else if (!changed.empty()) {
        tool.report_json("changed_since_relaxation", changed);
    }
    const RunResult result = solve(std::move(sample), scene, request.run, provenance, MPI_COMM_WORLD, request.control,
                                   tool, before ? &*before : nullptr);
    const bool quasi_static = scene.scheme == Scheme::quasi_static;
    tool.report("particles", result.particles);
    tool.report("particles_lost", result.particles_lost);
    tool.report("time_step", result.time_step, "s");
    tool.report("steps", result.cost.steps);
    if (result.cost.evaluations > 0) tool.report("evaluations", result.cost.evaluations);
    tool.report("final_strain", result.final_strain);
    if (!scene.duration) {
        tool.report("final_stress", result.final_stress, "Pa");
        tool.report("mean_equilibrium_error", result.mean_equilibrium_error);
    }
    if (!scene.duration && result.mean_equilibrium_error > large_equilibrium_error)
        tool.note(
            fmt::format("the forces of the two planes differ by {:.0f} %: {} or too few particles carry the "
                        "load; take {} or more particles",
                        100 * result.mean_equilibrium_error, quasi_static ? "forces without balance" : "inertia",
                        quasi_static ? "a smaller max_imbalance" : scene.law().traits().less_inertia));
    tool.report("processes", static_cast<std::int64_t>(result.cost.processes));
    tool.report("neighbour_builds", result.cost.neighbour_builds);
    if (result.predicted_wall_seconds > 0) tool.report("predicted_wall_seconds", result.predicted_wall_seconds, "s");
    tool.report("wall_seconds", result.cost.wall_seconds, "s");
    tool.report("cpu_seconds", result.cost.cpu_seconds, "s");
    tool.report("seconds_per_particle_step",
                result.cost.cpu_seconds / (static_cast<double>(result.particles) * result.cost.steps), "s");
    tool.report("peak_bytes", result.cost.peak_bytes, "B");
}

}  // namespace

int main(int argc, char** argv) {
    MpiSession mpi(argc, argv);
    return mpi.end(cli::main(argc, argv, usage, run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}
