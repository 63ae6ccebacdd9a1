// phantom_grains: round grains (label 1) that touch each other in void, with their truth.
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/grains.hpp"
#include "tools/phantom/truth.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    std::filesystem::path volume, truth, objects;
    std::string size = "100", diameter;
    double voxel_size = 0.0, fraction = 0.0, overlap = 0.1;
    std::int64_t count = 0, random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("phantom_grains", "Make a synthetic tomography: round grains (label 1) that touch, in void.")
        .output("VOLUME", request.volume, "Label volume to write; its truth goes into the .json file beside it.",
                {".tif", ".tiff"})
        .option("--size", request.size, "Number of voxels along each edge, as 100 or 100x100x150.")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "Edge of a voxel.")
        .option("--fraction", request.fraction, cli::Unit::fraction, {0, 1, false, false},
                "Volume of all spheres over that of the image; above 0.45 nearly all touch.")
        .option("--count", request.count, cli::Unit::none, cli::positive, "Number of grains.")
        .option("--diameter", request.diameter,
                "Diameter of the grains, as 60um, or its range, as 40um:80um. Give two of --fraction, --count and "
                "--diameter.")
        .option("--overlap", request.overlap, cli::Unit::fraction, {0, 0.5, true, false},
                "Part of the sum of their radii by which two grains may overlap.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another phantom.")
        .output_option("--truth", request.truth, "Write the truth to this file instead.", {".json"})
        .output_option("--objects", request.objects,
                       "Label volume of the true grains to write: 1, 2, ... in the order of the truth.",
                       {".tif", ".tiff"})
        .threads()
        .step(cli::Step::image)
        .example("phantom_grains sand.tif --voxel-size 3um --fraction 0.5 --count 40 --objects truth.tif");
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
    const auto grains =
        place_touching(draw_inclusions(wanted, edges.prod(), random), edges, request.overlap, random, tool);
    const Raster numbers = rasterise_numbers(grains, size, request.voxel_size, tool);
    const Raster phase = rasterise(grains, size, request.voxel_size, 1, 0, tool.threads(), tool);

    auto truth = truth_of(phase.volume, tool.provenance(), request.random_seed, {{0, "void"}, {1, "grain"}}, {});
    truth["count"] = grains.size();
    truth["objects"] = grains_truth(grains, numbers.voxels, 1, request.voxel_size);
    tool.report("count", static_cast<std::int64_t>(grains.size()));
    if (!request.objects.empty()) write_label_volume(numbers.volume, request.objects, tool);
    write_phantom(phase.volume, request.volume, truth, truth_file, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
