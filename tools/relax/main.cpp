// relax: let a free sample come to rest under its law.
#include "core/cli.hpp"
#include "core/packing_file.hpp"
#include "solver_plugin/mpi_tool.hpp"
#include "solver_plugin/solver.hpp"

namespace {

using namespace tomodem;

struct Request {
    std::filesystem::path sample, scene, relaxed;
    double periods = default_relaxation_periods;
};

cli::Usage usage(Request& request) {
    return cli::Usage("relax", "Let a free sample come to rest under its law.")
        .input("SAMPLE", request.sample, "sample of particles (.h5)")
        .input("SCENE", request.scene, "what the sample is made of (.toml)")
        .output("RELAXED", request.relaxed, "sample at rest to write (.h5)")
        .option("--periods", request.periods, cli::Unit::none, cli::positive, "how many natural periods to wait")
        .example("relax sample.h5 scene.toml relaxed.h5");
}

void run(const Request& request) {
    const Scene scene = read_scene(request.scene);
    const Packing sample = read_sample(request.sample);
    Provenance provenance = cli::provenance();
    provenance.scene = scene.text;
    const Relaxation result = relax(sample, scene, request.periods, MPI_COMM_WORLD);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0) write_packing(result.sample, request.relaxed, provenance);
    cli::report("particles", static_cast<std::int64_t>(sample.size()));
    cli::report("steps", result.cost.steps);
    cli::report("residual_energy", result.residual_energy, "N k_rep r_s^2");
    cli::report("largest_displacement", result.largest_displacement, "r_s");
    cli::report("processes", static_cast<std::int64_t>(result.cost.processes));
    cli::report("wall_seconds", result.cost.wall_seconds, "s");
    cli::report("cpu_seconds", result.cost.cpu_seconds, "s");
    cli::report("peak_bytes", result.cost.peak_bytes, "B");
}

}  // namespace

int main(int argc, char** argv) {
    return mpi_main(argc, argv, usage, run);
}
