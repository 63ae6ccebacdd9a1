// carve: take particles out of a sample and relax, until its pores are as large as those of the image.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "solver_plugin/run/mpi_session.hpp"
#include "tools/relax/carving.hpp"

namespace tomodem::relax {
namespace {

struct Request : CarveRequest {
    VolumeRequest volume_request;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("carve", "Take particles out of a sample and relax, until its pores are as large as the image's.");
    usage.input("SAMPLE", request.sample, "Dense sample, the void of the image filled (.h5, vol2pack --relabel 0=1).")
        .input("SCENE", request.scene,
               "Scene (.toml, docs/scene.md) that gives the phases of the sample and the law by which it relaxes.");
    return add_volume(usage, request.volume_request)
        .output("CARVED", request.carved, "Sample with its pores, at rest, to write.", {".h5"})
        .option("--pore-error", request.pore_error, cli::Unit::percent, {0, 100, false, true},
                "Allowed error of the volume of each closed pore whose diameter is at least --judged-from; smaller "
                "pores count in --total-error only.")
        .option("--total-error", request.total_error, cli::Unit::percent, {0, 100, false, true},
                "Largest error of the volume of all closed pores together.")
        .option("--judged-from", request.carve.judged_across, cli::Unit::particles, cli::positive,
                "Diameter from which the error of a single pore counts; of the sphere of the same volume.")
        .option("--min-pore", request.carve.min_across, cli::Unit::particles, {3, 1e6},
                "Diameter of the smallest pore that is carved; smaller ones are left solid.")
        .option("--first-share", request.carve.first_share, cli::Unit::fraction, {0, 1, false, true},
                "Share of the particles of each pore that is taken out in the first iteration; later ones take what is "
                "still missing.")
        .option("--max-iterations", request.max_iterations, cli::Unit::none, {0, 1e6},
                "Largest number of iterations; if the pores do not match the image by then, carve fails. 0 only "
                "measures the sample.")
        .option("--energy-ratio", request.limits.energy_ratio, cli::Unit::none, cli::positive,
                "Kinetic over elastic energy at the end of each relaxation, as of relax.")
        .option("--force-balance", request.limits.force_balance, cli::Unit::none, cli::positive,
                "Net force over the sum of forces at the end of each relaxation, as of relax.")
        .option("--max-periods", request.limits.max_periods, cli::Unit::none, cli::positive,
                "Number of natural periods after which each relaxation ends, as of relax.")
        .output_option("--table", request.table, "Table of the iterations. By default it is written beside CARVED.",
                       {".csv"})
        .output_option(
            "--pores", request.pores,
            "Also write a table with one row for each pore: its volume in the finished sample and in the image, "
            "and its error.",
            {".csv"})
        .flag("--resume", request.resume,
              "Resume from CARVED.state, which is kept after each iteration until the sample is complete.")
        .step(cli::Step::sample)
        .threads()
        .example("carve dense.h5 scene.toml stack/ carved.h5 --voxel-size 2.4um");
}

void run(const Request& request, cli::Tool& tool) {
    CarveRequest wanted = request;
    wanted.image = request.volume_request.path;
    wanted.volume = volume_options(request.volume_request);
    carve(wanted, tool.provenance(), tool.threads(), MPI_COMM_WORLD, tool);
}

}  // namespace
}  // namespace tomodem::relax

int main(int argc, char** argv) {
    using namespace tomodem;
    MpiSession mpi(argc, argv);
    return mpi.end(
        cli::main(argc, argv, relax::usage, relax::run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}
