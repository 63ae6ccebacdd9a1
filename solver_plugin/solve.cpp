// solve: press a sample as a scene says, on LIGGGHTS, and write its frames and curves.
#include "solver_plugin/solver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/cli.hpp"
#include "core/expected_flow.hpp"
#include "core/packing_file.hpp"
#include "solver_plugin/explain.hpp"
#include "solver_plugin/mpi_tool.hpp"

namespace {

using namespace tomodem;

/// Of the mean over the second half of the path: above, the curves say more of inertia than of the material.
constexpr double large_equilibrium_error = 0.1;

struct Request {
    std::filesystem::path sample, scene, run;
    RunControl control;
    bool explain = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage("solve", "Press a sample of particles as a scene says, and write its frames and curves.")
        .input("SAMPLE", request.sample, "sample of particles (.h5), relaxed first if it is not")
        .input("SCENE", request.scene, "what the sample is made of and what is done to it (.toml)")
        .output("RUN", request.run, "frames and curves to write (.h5)")
        .flag("--resume", request.control.resume,
              "go on from RUN.checkpoint, which an interrupted run has left; without one, start from the beginning")
        .option("--checkpoint-every", request.control.checkpoint_minutes, cli::Unit::none, cli::not_negative,
                "minutes of wall time between two checkpoints; 0: none at all")
        .flag("--explain", request.explain,
              "check the scene and say what it switches on, how many steps it takes, and, from two seconds of it on "
              "this machine, how long and how much memory; RUN is not written")
        .example("solve relaxed.h5 scene.toml run.h5")
        .example("solve relaxed.h5 scene.toml run.h5 --explain")
        .example("solve relaxed.h5 scene.toml run.h5 --resume")
        .example("mpirun -np 2 solve relaxed.h5 scene.toml run.h5 --json run.json");
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) result += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return result + '"';
}

/// What the calibration promises of each phase that is given by norton; warns outside of what it was measured on.
void tell(const Scene& scene, const std::vector<ExpectedFlow>& flows) {
    if (flows.empty()) return;
    cli::report("calibration", scene.calibration ? scene.flow_table().name : "shipped, " + scene.flow_table().name);
    std::string rows;
    for (const ExpectedFlow& one : flows) {
        std::string outside;
        for (const std::string& what : one.outside) outside += (outside.empty() ? "" : ", ") + quoted(what);
        if (!one.outside.empty())
            cli::note(
                fmt::format("[phase.{}] is outside its calibration: {}", one.phase, fmt::join(one.outside, "; ")));
        cli::report(
            "expected_flow_" + one.phase,
            fmt::format("{:.4g} MPa within {:.0f} % (packings {:.1f}, rates {:.1f}, size {:.1f}, time step {:.1f}), "
                        "{:.3g} to {:.3g} /s, strain {:g} to {:g}{}",
                        one.stress / 1e6, 100 * one.error, 100 * one.packings, 100 * one.rates, 100 * one.size,
                        100 * one.time_step, one.rate[0], one.rate[1], one.strain[0], one.strain[1],
                        one.outside.empty() ? "" : "; this scene is outside"));
        rows += fmt::format(
            R"({}{{"phase": {}, "label": {}, "stress": {}, "error": {}, "error_packings": {}, "error_rates": {}, )"
            R"("error_size": {}, "error_time_step": {}, "rate_from": {}, "rate_to": {}, "strain_from": {}, )"
            R"("strain_to": {}, "outside": [{}]}})",
            rows.empty() ? "" : ", ", quoted(one.phase), one.label, one.stress, one.error, one.packings, one.rates,
            one.size, one.time_step, one.rate[0], one.rate[1], one.strain[0], one.strain[1], outside);
    }
    cli::report_json("expected_flow", "[" + rows + "]");
}

void tell(const Explanation& found) {
    for (const Ingredient& one : found.ingredients)
        cli::report(one.name, fmt::format("{}: {}", one.on ? "on" : "off", one.why));
    cli::report("particles", found.particles);
    cli::report("processes", static_cast<std::int64_t>(found.processes));
    cli::report("time_step", found.time_step, "s");
    cli::report("time_step_reason", found.time_step_reason);
    cli::report("steps", found.steps);
    cli::report("seconds_per_particle_step", found.seconds_per_particle_step, "s");
    cli::report("predicted_wall_seconds", found.wall_seconds, "s");
    cli::report("predicted_peak_bytes", found.peak_bytes, "B");
}

void run(const Request& request) {
    const Scene scene = read_scene(request.scene);
    Packing sample = read_sample(request.sample);
    if (request.explain) {
        const Explanation found = explain(sample, scene, MPI_COMM_WORLD);
        tell(found);
        tell(scene, found.flows);
        return;
    }
    Provenance provenance = cli::provenance();
    provenance.scene = scene.text;
    for (const Wall& wall : scene.walls)  // one that is not there is told with its line, later
        if (std::filesystem::exists(wall.surface))
            provenance.inputs[wall.surface.string()] = content_digest(wall.surface);
    if (!scene.calibration_file.empty())
        provenance.inputs[scene.calibration_file.string()] = content_digest(scene.calibration_file);
    if (request.control.resume && is_complete(request.run, provenance)) {
        cli::note(fmt::format("'{}' is complete: nothing to do", request.run.string()));
        return;
    }
    const std::vector<ExpectedFlow> flows =
        expected_flows(scene, static_cast<std::int64_t>(sample.size()), compile_model(scene, sample));
    tell(scene, flows);
    const RunResult result = solve(std::move(sample), scene, request.run, provenance, MPI_COMM_WORLD, request.control);
    cli::report("particles", result.particles);
    cli::report("particles_lost", result.particles_lost);
    cli::report("time_step", result.time_step, "s");
    cli::report("steps", result.cost.steps);
    cli::report("final_strain", result.final_strain);
    if (!scene.duration) {
        cli::report("final_stress", result.final_stress, "Pa");
        cli::report("mean_equilibrium_error", result.mean_equilibrium_error);
    }
    if (!scene.duration && result.mean_equilibrium_error > large_equilibrium_error)
        cli::note(
            fmt::format("the forces of the two planes differ by {:.0f} %: inertia or too few particles carry the "
                        "load; take {} or more particles",
                        100 * result.mean_equilibrium_error,
                        scene.phases.front().law == Law::norton ? "a smaller equilibrium_error"
                                                                : "a lower rate, a smaller strain_per_step"));
    cli::report("processes", static_cast<std::int64_t>(result.cost.processes));
    cli::report("neighbour_builds", result.cost.neighbour_builds);
    if (result.predicted_wall_seconds > 0) cli::report("predicted_wall_seconds", result.predicted_wall_seconds, "s");
    cli::report("wall_seconds", result.cost.wall_seconds, "s");
    cli::report("cpu_seconds", result.cost.cpu_seconds, "s");
    cli::report("seconds_per_particle_step",
                result.cost.cpu_seconds / (static_cast<double>(result.particles) * result.cost.steps), "s");
    cli::report("peak_bytes", result.cost.peak_bytes, "B");
}

}  // namespace

int main(int argc, char** argv) {
    return mpi_main(argc, argv, usage, run);
}
