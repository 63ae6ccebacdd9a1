// carve: take particles out of a sample and relax, until its pores are as large as those of the image.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "solver_plugin/run/mpi_session.hpp"
#include "tools/relax/carving.hpp"

namespace {

using namespace tomodem;

struct Request : CarveRequest {
    VolumeRequest volume_request;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("carve", "Take particles out of a sample and relax, until its pores are as large as the image's.");
    usage.input("sample", request.sample, "dense sample, the image's void filled (.h5: vol2pack --relabel 0=1)")
        .input("scene", request.scene, "what the sample is made of (.toml)");
    return add_volume(usage, request.volume_request)
        .output("carved", request.carved, "sample with its pores, at rest, to write (.h5)")
        .option("--pore-error", request.pore_error, cli::Unit::percent, {0, 100, false, true},
                "of the volume of each pore that is judged")
        .option("--total-error", request.total_error, cli::Unit::percent, {0, 100, false, true},
                "of the volume of all closed pores together")
        .option("--judged-from", request.carve.judged_across, cli::Unit::particles, cli::positive,
                "smallest pore whose own error counts: diameter of the sphere of its volume")
        .option("--least-pore", request.carve.least_across, cli::Unit::particles, {3, 1e6},
                "smaller pores are left solid")
        .option("--first-share", request.carve.first_share, cli::Unit::fraction, {0, 1, false, true},
                "of each pore that is taken out at first; the rest follows as it is missing")
        .option("--max-iterations", request.max_iterations, cli::Unit::none, {0, 1e6},
                "then it is an error; 0 measures the sample as it is")
        .option("--energy-ratio", request.limits.energy_ratio, cli::Unit::none, cli::positive,
                "of each relaxation, as of 'relax'")
        .option("--force-balance", request.limits.force_balance, cli::Unit::none, cli::positive,
                "of each relaxation, as of 'relax'")
        .option("--max-periods", request.limits.max_periods, cli::Unit::none, cli::positive,
                "of each relaxation, as of 'relax'")
        .output_option("--table", request.table, "table of the iterations (.csv); default: beside the sample written")
        .output_option("--pores", request.pores, "table of the pores at the end (.csv)")
        .flag("--resume", request.resume, "go on from CARVED.state, which each iteration leaves until the end")
        .example("carve dense.h5 scene.toml stack/ carved.h5 --voxel-size 2.4um");
}

void run(const Request& request, cli::Tool& tool) {
    CarveRequest wanted = request;
    wanted.image = request.volume_request.path;
    wanted.volume = volume_options(request.volume_request);
    carve(wanted, tool.provenance(), tool.threads(), MPI_COMM_WORLD, tool);
}

}  // namespace

int main(int argc, char** argv) {
    MpiSession mpi(argc, argv);
    return mpi.end(cli::main(argc, argv, usage, run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}
