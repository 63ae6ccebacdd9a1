// height: height of the sample along the load at every frame of a run. A measure as somebody would add it to the tools:
// one source, which the build finds, and which declares how pages show it.
#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/metrics/curves/strain_curves.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path run, table;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"height", "Height of the sample along the z axis, frame by frame."}
        .input("RUN", request.run, "Run (.h5) to measure.")
        .output("TABLE", request.table, "Table to write, with one row for each frame.", {".csv"})
        .step(cli::Step::measure)
        .measure({.heading = "Height of the sample",
                  .results = {{"height_last", "height at the end", "µm", 1e3}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"height", "height", "µm", 1e3}}})
        .example("height run.h5 height.csv");
}

double height(const Frame& frame, double seed_radius) {
    const auto [low, high] = std::minmax_element(frame.position.begin(), frame.position.end(),
                                                 [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    return high->z() - low->z() + 2.0 * seed_radius;
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.run);
    Table table({"frame [-]", "strain [-]", "height [mm]"});
    double last = 0.0;
    for (std::size_t i = 0; i < reader.frame_count(); ++i) {
        last = height(reader.frame(i), reader.packing().seed_radius);
        table.add({std::int64_t(i), frame_strain(reader, i), last});
    }
    table.write(request.table);
    tool.report("height_last", last, "mm");
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
