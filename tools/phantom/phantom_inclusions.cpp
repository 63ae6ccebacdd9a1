// phantom_inclusions: spherical inclusions (label 2) in a matrix (label 1), with their truth.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/grains.hpp"
#include "tools/phantom/truth.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    std::filesystem::path volume, truth;
    std::string size = "100", diameter;
    double voxel_size = 0.0, fraction = 0.0, gap = 2.0;
    std::int64_t count = 0, random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("phantom_inclusions",
                      "Make a synthetic tomography: spherical inclusions (label 2) in a matrix (label 1).")
        .output("VOLUME", request.volume, "Label volume to write; its truth goes into the .json file beside it.",
                {".tif", ".tiff"})
        .option("--size", request.size, "Number of voxels along each edge, as 100 or 100x100x150.")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "Edge of a voxel.")
        .option("--fraction", request.fraction, cli::Unit::fraction, {0, 1, false, false},
                "Volume fraction of the inclusions.")
        .option("--count", request.count, cli::Unit::none, cli::positive, "Number of inclusions.")
        .option("--diameter", request.diameter,
                "Diameter of the inclusions, as 60um, or its range, as 40um:80um. Give two of --fraction, --count and "
                "--diameter.")
        .option("--gap", request.gap, cli::Unit::voxels, cli::not_negative,
                "Smallest distance of an inclusion from others and from the faces; below 2 their voxels may touch.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another phantom.")
        .output_option("--truth", request.truth, "Write the truth to this file instead.", {".json"})
        .threads()
        .step(cli::Step::image)
        .example("phantom_inclusions composite.tif --voxel-size 2.4um --fraction 0.2 --count 20")
        .example(
            "phantom_inclusions composite.tif --size 200x200x300 --voxel-size 2.4um --fraction 0.1 "
            "--diameter 40um:80um");
}

void run(const Request& request, cli::Tool& tool) {
    InclusionRequest wanted;
    if (tool.given("--fraction")) wanted.fraction = request.fraction;
    if (tool.given("--count")) wanted.count = request.count;
    wanted.diameter = diameter_range(request.diameter);
    const VoxelIndex size = parse_size("--size", request.size);
    const auto truth_file = truth_path(request.volume, request.truth);
    const Vec3 edges = request.voxel_size * Vec3(size[0], size[1], size[2]);

    Random random(static_cast<std::uint64_t>(request.random_seed));
    const auto drawn = draw_inclusions(wanted, edges.prod(), random);
    const auto grains = place_without_overlap(drawn, edges, request.gap * request.voxel_size, random, tool);
    const Raster raster = rasterise(grains, size, request.voxel_size, 2, 1, tool.threads(), tool);

    double volume = 0;
    for (const Grain& grain : grains) volume += grain_volume(grain);
    const double fraction = volume / edges.prod();
    auto truth = truth_of(raster.volume, tool.provenance(), request.random_seed, {{1, "matrix"}, {2, "inclusion"}},
                          {{1, 1 - fraction}, {2, fraction}});
    truth["count"] = grains.size();
    truth["objects"] = grains_truth(grains, raster.voxels, 2, request.voxel_size);
    tool.report("count", static_cast<std::int64_t>(grains.size()));
    write_phantom(raster.volume, request.volume, truth, truth_file, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
