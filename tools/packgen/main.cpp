// packgen: a periodic random dense packing of equal spheres, the brick that vol2pack masks with an image.
#include "core/cli.hpp"
#include "core/packing_file.hpp"
#include "tools/packgen/compaction.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path packing;
    std::int64_t particles = 0;
    double density = 0.0;
    double seed_radius = 0.5;  // mm
    std::int64_t random_seed = 1;
};

cli::Usage usage(Request& request) {
    return cli::Usage("packgen",
                      "Make a periodic cubic random packing of equal spheres by compaction of random points.")
        .output("packing", request.packing, "packing to write (.h5)")
        .required("--particles", request.particles, cli::Unit::particles, {1, 1e9}, "number of spheres")
        .required("--density", request.density, cli::Unit::none, {packgen::lowest_density, packgen::highest_density},
                  "D = N pi d^3 / (6 V), d = 2 r_s; random close packing is 0.64, more makes spheres overlap")
        .option("--seed-radius", request.seed_radius, cli::Unit::length, cli::positive, "radius r_s of the spheres")
        .option("--random-seed", request.random_seed, cli::Unit::none, cli::not_negative,
                "the same number gives the same packing")
        .example("packgen brick.h5 --particles 20000 --density 0.70");
}

void run(const Request& request) {
    cli::Progress progress("compaction", 1.0);
    const packgen::CompactedPacking made = packgen::compact({.particles = request.particles,
                                                             .density = request.density,
                                                             .seed_radius = request.seed_radius,
                                                             .random_seed = request.random_seed,
                                                             .threads = cli::threads(),
                                                             .progress = [&](double done) { progress.update(done); }});
    const packgen::ContactStatistics contacts = packgen::contact_statistics(made.packing);
    write_packing(made.packing, request.packing, cli::provenance());
    cli::report("particles", request.particles);
    cli::report("density", made.packing.density());
    cli::report("box_edge", made.packing.box.edges[0], "mm");
    cli::report("max_overlap", contacts.max_overlap, "d");
    cli::report("mean_overlap", contacts.mean_overlap, "d");
    cli::report("mean_coordination", contacts.mean_coordination);
    cli::report("steps", made.steps);
    cli::report("residual", made.residual, "k d");
    cli::report("load", made.load, "k d");
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
