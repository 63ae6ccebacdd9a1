// jittered_brick: a periodic packing to test with: a simple cubic lattice, each point moved a little.
#include <cmath>
#include <random>

#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path brick;
    std::int64_t edge = 20;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("jittered_brick", "Periodic packing to test with.");
    usage.output("BRICK", request.brick, "packing to write")
        .option("--edge", request.edge, cli::Unit::particles, cli::positive, "particles along an edge");
    return usage;
}

void run(const Request& request, cli::Tool& tool) {
    Packing brick;
    brick.seed_radius = 0.5;
    // The density of a random packing, D = 0.7.
    const double spacing = std::cbrt(4.0 / 3 * M_PI * 0.125 / 0.7);
    brick.box.edges = Vec3::Constant(spacing * static_cast<double>(request.edge));
    brick.box.periodic = {true, true, true};
    std::mt19937_64 random(1);
    const auto jitter = [&] { return 0.6 * (static_cast<double>(random() >> 11) * 0x1p-53); };
    for (std::int64_t z = 0; z < request.edge; ++z)
        for (std::int64_t y = 0; y < request.edge; ++y)
            for (std::int64_t x = 0; x < request.edge; ++x)
                brick.position.push_back(spacing * (Vec3(x, y, z) + Vec3(jitter(), jitter(), jitter())));
    brick.species.assign(brick.size(), 1);
    for (std::size_t i = 0; i < brick.size(); ++i) brick.id.push_back(static_cast<std::int64_t>(i + 1));
    write_packing(brick, request.brick, tool.provenance());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
