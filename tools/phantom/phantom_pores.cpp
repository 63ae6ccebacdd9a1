// phantom_pores: closed casting pores (label 0) in a solid (label 1), with their truth.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/grains.hpp"
#include "tools/phantom/truth.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    std::filesystem::path volume, truth;
    std::string size = "100";
    double voxel_size = 0.0, gap = 2.0;
    PoreRequest pores{.porosity = 0.0, .median_diameter = 0.0, .spread = 0.3, .cluster_share = 0.2};
    std::int64_t random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("phantom_pores",
                      "Make a synthetic tomography: closed casting pores (label 0) in a solid (label 1).")
        .output("VOLUME", request.volume, "Label volume to write; its truth goes into the .json file beside it.",
                {".tif", ".tiff"})
        .option("--size", request.size, "Number of voxels along each edge, as 100 or 100x100x150.")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "Edge of a voxel.")
        .required("--porosity", request.pores.porosity, cli::Unit::fraction, {0, 1, false, false},
                  "Volume fraction of the pores.")
        .required("--median-diameter", request.pores.median_diameter, cli::Unit::length, cli::positive,
                  "Median diameter of the pores, each taken as the sphere of equal volume.")
        .option("--spread", request.pores.spread, cli::Unit::none, cli::not_negative,
                "Standard deviation of the natural logarithm of the diameter (a log-normal distribution).")
        .option("--clusters", request.pores.cluster_share, cli::Unit::fraction, {0, 1},
                "Fraction of the pores that are clusters of 3 to 5 overlapping spheres; the others are spheres.")
        .option("--gap", request.gap, cli::Unit::voxels, cli::not_negative,
                "Smallest distance of a pore from others and from the faces; below 2 their voxels may touch.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another phantom.")
        .output_option("--truth", request.truth, "Write the truth to this file instead.", {".json"})
        .threads()
        .step(cli::Step::image)
        .example("phantom_pores casting.tif --size 120 --voxel-size 10um --porosity 0.02 --median-diameter 120um");
}

void run(const Request& request, cli::Tool& tool) {
    const VoxelIndex size = parse_size("--size", request.size);
    const auto truth_file = truth_path(request.volume, request.truth);
    const Vec3 edges = request.voxel_size * Vec3(size[0], size[1], size[2]);

    Random random(static_cast<std::uint64_t>(request.random_seed));
    const auto drawn = draw_pores(request.pores, edges.prod(), random);
    const auto pores = place_without_overlap(drawn, edges, request.gap * request.voxel_size, random, tool);
    const Raster raster = rasterise(pores, size, request.voxel_size, 0, 1, tool.threads(), tool);

    auto truth = truth_of(raster.volume, tool.provenance(), request.random_seed, {{0, "pore"}, {1, "solid"}},
                          {{0, request.pores.porosity}, {1, 1 - request.pores.porosity}});
    truth["count"] = pores.size();
    truth["objects"] = grains_truth(pores, raster.voxels, 0, request.voxel_size);
    tool.report("count", static_cast<std::int64_t>(pores.size()));
    write_phantom(raster.volume, request.volume, truth, truth_file, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
