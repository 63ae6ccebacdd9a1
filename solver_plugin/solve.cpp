// solve: press a sample as a scene says, on LIGGGHTS, and write its frames and curves.
#include "solver_plugin/solver.hpp"

#include <fmt/format.h>

#include "core/cli.hpp"
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
        tell(explain(sample, scene, MPI_COMM_WORLD));
        return;
    }
    Provenance provenance = cli::provenance();
    provenance.scene = scene.text;
    for (const Wall& wall : scene.walls)  // one that is not there is told with its line, later
        if (std::filesystem::exists(wall.surface))
            provenance.inputs[wall.surface.string()] = content_digest(wall.surface);
    if (request.control.resume && is_complete(request.run, provenance)) {
        cli::note(fmt::format("'{}' is complete: nothing to do", request.run.string()));
        return;
    }
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
                        "load; take a lower rate, a smaller strain_per_step or more particles",
                        100 * result.mean_equilibrium_error));
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
