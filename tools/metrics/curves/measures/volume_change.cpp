// volume_change: volume of the sample at every frame of a run against the first.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "core/surface/alpha_surface.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/curves/volume_series.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;

struct Request {
    std::filesystem::path run, table;
    double probe_radius = 0.0;  // mm; 0: one particle diameter
};

cli::Usage usage(Request& request) {
    return cli::Usage{"volume_change", "Volume of the sample (alpha shape of the centres) along a run."}
        .input("RUN", request.run, "Run (.h5) to measure.")
        .output("TABLE", request.table, "Table to write, with one row for each frame.", {".csv"})
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "Fill the gaps between centres that a ball of this radius cannot enter; the default is one particle "
                "diameter.")
        .step(cli::Step::measure)
        .measure({.heading = "Volume of the envelope",
                  .results = {{"volume_change_last", "volume change of the envelope", "%", 100},
                              {"volume_change_extreme", "volume change, largest on the way", "%", 100},
                              {"components_last", "separate parts at the end", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"volume_change", "volume change", "%", 100}}})
        .threads()
        .example("volume_change run.h5 volume.csv --probe-radius 1mm");
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.run);
    const double probe_radius =
        tool.given("--probe-radius") ? request.probe_radius : default_probe_radius(reader.packing().seed_radius);
    std::vector<double> strain;
    for (std::size_t i = 0; i < reader.frame_count(); ++i) strain.push_back(frame_strain(reader, i));

    const auto progress = tool.progress("alpha shapes", double(reader.frame_count()));
    const std::vector<FrameVolume> frames =
        volume_series(reader, probe_radius, tool.threads(), [&](double done) { progress->update(done); });

    Table table({"frame [-]", "time [s]", "strain [-]", "abs_strain [-]", "volume [mm^3]", "volume_change [-]",
                 "area [mm^2]", "components [-]"});
    double extreme = 0.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const double change = frames[i].volume / frames[0].volume - 1.0;
        if (std::abs(change) > std::abs(extreme)) extreme = change;
        table.add({std::int64_t(i), reader.frame_time(i), strain[i], std::abs(strain[i]), frames[i].volume, change,
                   frames[i].area, std::int64_t(frames[i].components)});
    }
    table.write(request.table);

    tool.report("frames", std::int64_t(frames.size()));
    tool.report("probe_radius", probe_radius, "mm");
    tool.report("volume_first", frames.front().volume, "mm^3");
    tool.report("volume_last", frames.back().volume, "mm^3");
    tool.report("volume_change_last", frames.back().volume / frames.front().volume - 1.0);
    tool.report("volume_change_extreme", extreme);
    tool.report("components_last", std::int64_t(frames.back().components));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
