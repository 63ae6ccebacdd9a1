// phantom_fibres: straight fibres (label 1) in void (0), joined where they cross, of a given relative density, with the
// truth.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/fibres.hpp"
#include "tools/phantom/truth.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    std::filesystem::path volume, truth;
    std::string size = "100";
    double voxel_size = 0.0, relative_density = 0.0, out_of_plane = 0.2;
    std::int64_t fibres = 40, random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("phantom_fibres",
                      "Make a synthetic tomography: straight fibres (label 1) of a given relative density.")
        .output("VOLUME", request.volume, "Label volume to write; its truth goes into the .json file beside it.",
                {".tif", ".tiff"})
        .option("--size", request.size, "Number of voxels along each edge, as 100 or 100x100x150.")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "Edge of a voxel.")
        .required("--relative-density", request.relative_density, cli::Unit::fraction, {0, 0.6, false, true},
                  "Fraction of the voxels that is solid; the radius of the fibres follows from it.")
        .option("--fibres", request.fibres, cli::Unit::none, {2, 10000},
                "Number of fibres; all go through the whole volume, and are joined where they cross.")
        .option("--out-of-plane", request.out_of_plane, cli::Unit::fraction, {0, 1},
                "0 lays all fibres in x-y planes; 1 gives them every direction.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another phantom.")
        .output_option("--truth", request.truth, "Write the truth to this file instead.", {".json"})
        .threads()
        .step(cli::Step::image)
        .example("phantom_fibres fibres.tif --size 120 --voxel-size 4um --relative-density 0.15");
}

void run(const Request& request, cli::Tool& tool) {
    const VoxelIndex size = parse_size("--size", request.size);
    const auto truth_file = truth_path(request.volume, request.truth);
    Random random(static_cast<std::uint64_t>(request.random_seed));
    const auto fibres = fibre_struts(request.voxel_size * Vec3(size[0], size[1], size[2]), request.fibres,
                                     request.out_of_plane, random);
    const Foam drawn = draw_foam(fibres, size, request.voxel_size, request.relative_density, tool.threads(), tool);

    auto truth = truth_of(drawn.volume, tool.provenance(), request.random_seed, {{0, "void"}, {1, "fibre"}}, {});
    truth["relative_density"] = request.relative_density;
    truth["fibres"] = request.fibres;
    truth["fibre_radius_mm"] = drawn.strut_radius;
    truth["fibre_radius_voxels"] = drawn.strut_radius / request.voxel_size;
    truth["out_of_plane"] = request.out_of_plane;
    truth["solid_components"] = 1;
    tool.report("fibre_radius", drawn.strut_radius, "mm");
    tool.report("fibre_radius_voxels", drawn.strut_radius / request.voxel_size, "voxels");
    write_phantom(drawn.volume, request.volume, truth, truth_file, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
