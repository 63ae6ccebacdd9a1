// relax: let a free sample come to rest under its law.
#include "core/cli.hpp"
#include "core/packing_file.hpp"
#include "solver_plugin/mpi_tool.hpp"
#include "solver_plugin/solver.hpp"

namespace {

using namespace tomodem;

struct Request {
    std::filesystem::path sample, scene, relaxed;
    RestLimits limits;
};

cli::Usage usage(Request& request) {
    return cli::Usage("relax", "Let a free sample come to rest under its law.")
        .input("SAMPLE", request.sample, "sample of particles (.h5)")
        .input("SCENE", request.scene, "what the sample is made of (.toml)")
        .output("RELAXED", request.relaxed, "sample at rest to write (.h5)")
        .option("--energy-ratio", request.limits.energy_ratio, cli::Unit::none, cli::positive,
                "at rest when kinetic over elastic energy is at most this; default 1e-5, law norton 1e-3")
        .option("--force-balance", request.limits.force_balance, cli::Unit::none, cli::positive,
                "and the net force on a particle over the sum of its forces this; default 1e-3, law norton 1e-2")
        .option("--max-periods", request.limits.max_periods, cli::Unit::none, cli::positive,
                "natural periods after which it ends all the same, with a warning")
        .example("relax sample.h5 scene.toml relaxed.h5");
}

void run(const Request& request) {
    const Scene scene = read_scene(request.scene);
    const Packing sample = read_sample(request.sample);
    Provenance provenance = cli::provenance();
    provenance.scene = scene.text;
    const Relaxation result = relax(sample, scene, request.limits, MPI_COMM_WORLD);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0) write_packing(result.sample, request.relaxed, provenance);
    cli::report("particles", static_cast<std::int64_t>(sample.size()));
    cli::report("steps", result.cost.steps);
    cli::report("at_rest", static_cast<std::int64_t>(result.at_rest));
    cli::report("periods", result.periods);
    cli::report("energy_ratio", result.energy_ratio);
    cli::report("force_balance", result.force_balance);
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
