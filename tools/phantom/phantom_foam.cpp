// phantom_foam: an open-cell foam (label 1 in void 0) of a given relative density, with its truth.
#include <algorithm>

#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "tools/phantom/foam.hpp"
#include "tools/phantom/truth.hpp"

namespace tomodem::phantom {
namespace {

struct Request {
    std::filesystem::path volume, truth;
    std::string size = "100";
    double voxel_size = 0.0, relative_density = 0.0, irregularity = 0.5;
    std::int64_t cells = 3, random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("phantom_foam",
                      "Make a synthetic tomography: open-cell foam (label 1) of a given relative density.")
        .output("VOLUME", request.volume, "Label volume to write; its truth goes into the .json file beside it.",
                {".tif", ".tiff"})
        .option("--size", request.size, "Number of voxels along each edge, as 100 or 100x100x150.")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "Edge of a voxel.")
        .required("--relative-density", request.relative_density, cli::Unit::fraction, {0, 0.6, false, true},
                  "Fraction of the voxels that is solid; the radius of the struts follows from it.")
        .option("--cells", request.cells, cli::Unit::none, {1, 100},
                "Number of unit cells along the shortest edge of the volume; a unit cell is a cube that holds two "
                "cells of the foam (body-centred cubic).")
        .option("--irregularity", request.irregularity, cli::Unit::fraction, {0, 1},
                "0 gives Kelvin's cells, all alike; 1 moves the centres of the cells by up to half their distance.")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "Seed of the random numbers; each gives another phantom.")
        .output_option("--truth", request.truth, "Write the truth to this file instead.", {".json"})
        .threads()
        .step(cli::Step::image)
        .example("phantom_foam foam.tif --size 150 --voxel-size 20um --relative-density 0.1 --cells 4");
}

void run(const Request& request, cli::Tool& tool) {
    const VoxelIndex size = parse_size("--size", request.size);
    const auto truth_file = truth_path(request.volume, request.truth);
    const Vec3 edges = request.voxel_size * Vec3(size[0], size[1], size[2]);
    const double cell = edges.minCoeff() / static_cast<double>(request.cells);

    Random random(static_cast<std::uint64_t>(request.random_seed));
    const auto struts = foam_struts(edges, cell, request.irregularity, random, tool);
    const Foam foam = draw_foam(struts, size, request.voxel_size, request.relative_density, tool.threads(), tool);

    auto truth = truth_of(foam.volume, tool.provenance(), request.random_seed, {{0, "void"}, {1, "solid"}}, {});
    truth["relative_density"] = request.relative_density;
    truth["strut_radius_mm"] = foam.strut_radius;
    truth["strut_radius_voxels"] = foam.strut_radius / request.voxel_size;
    truth["mean_cell_volume_mm3"] = cell * cell * cell / 2;
    truth["irregularity"] = request.irregularity;
    truth["solid_components"] = 1;
    tool.report("strut_radius", foam.strut_radius, "mm");
    tool.report("strut_radius_voxels", foam.strut_radius / request.voxel_size, "voxels");
    write_phantom(foam.volume, request.volume, truth, truth_file, tool);
}

}  // namespace
}  // namespace tomodem::phantom

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::phantom::usage, tomodem::phantom::run);
}
