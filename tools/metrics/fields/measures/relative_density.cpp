// relative_density: the share of the space that a structure takes up which is solid, frame by frame.
#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/surface/filling.hpp"
#include "tools/metrics/fields/run_frames.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, table;
    std::string frames = "all";
};

cli::Usage usage(Request& request) {
    return cli::Usage{
        "relative_density",
        "Relative density: volume of the solid over the volume of the box, and of the convex hull, around "
        "it. Pores, open or closed, need no lid."}
        .input("RUN", request.run, "Run or sample (.h5) to measure.")
        .output("TABLE", request.table, "Table to write, with one row for each frame.", {".csv"})
        .option("--frames", request.frames, "Frames to measure: all, first, last or a number from 0.")
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Relative density",
                  .results = {{"relative_density_last", "relative density (box), at the end", "%", 100},
                              {"relative_density_first", "relative density (box), first frame", "%", 100},
                              {"relative_density", "relative density (box)", "%", 100},
                              {"relative_density_hull_last", "relative density (convex hull), at the end", "%", 100},
                              {"relative_density_hull_first", "relative density (convex hull), first frame", "%", 100},
                              {"relative_density_hull", "relative density (convex hull)", "%", 100},
                              {"solid_change_last", "change of the volume of the solid", "%", 100}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"relative_density", "in the box", "%", 100},
                             {"relative_density_hull", "in the convex hull", "%", 100}}})
        .example("relative_density run.h5 relative_density.csv");
}

struct Measured {
    double solid, particle, box, hull;  // mm^3
};

/// Along a periodic axis the box of the frame, along the others the smallest around the centres.
double box_volume(const std::vector<Vec3>& centres, const Box& box) {
    Vec3 low = centres.front(), high = low;
    for (const Vec3& centre : centres) low = low.cwiseMin(centre), high = high.cwiseMax(centre);
    Vec3 edges = high - low;
    for (int axis = 0; axis < 3; ++axis)
        if (box.periodic[std::size_t(axis)]) edges[axis] = box.edges[axis];
    return edges.prod();
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const RunReader& reader = frames.run();
    const double seed_radius = frames.packing().seed_radius;
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, reader.frame_count());
    const std::vector<std::int32_t> particles =
        without_loose(reader.frame(reader.frame_count() - 1).position, seed_radius, tool.threads());

    std::vector<Measured> measured(chosen.size());
    const auto progress = tool.progress("frames", double(chosen.size()));
    std::mutex mutex;
    double done = 0.0;
    parallel_for(std::int64_t(chosen.size()), tool.threads(), [&](std::int64_t k) {
        const std::size_t index = chosen[std::size_t(k)];
        const std::vector<Vec3> centres = centres_of(reader.frame(index).position, particles);
        const Filling filling = filling_of(centres, seed_radius);
        if (!(filling.solid > 0.0))
            throw InvalidInput(fmt::format(
                "frame {}: hardly any four particles lie close together, so the volume of a particle with its share of "
                "the gaps is not known: the structure is thinner than a particle; make the sample with fewer "
                "--pixels-per-seed",
                index));
        measured[std::size_t(k)] = {filling.solid, filling.particle, box_volume(centres, frames.box(index)),
                                    filling.hull};
        const std::scoped_lock lock(mutex);
        progress->update(++done);
    });

    Table table(RunFrames::columns({"relative_density [-]", "relative_density_hull [-]", "solid_volume [mm^3]",
                                    "particle_volume [mm^3]", "box_volume [mm^3]", "hull_volume [mm^3]"}));
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        const auto& [solid, particle, box, hull] = measured[k];
        table.add(frames.row(chosen[k], {solid / box, solid / hull, solid, particle, box, hull}));
    }
    table.write(request.table);

    tool.report("frames", std::int64_t(chosen.size()));
    tool.report("particles", std::int64_t(particles.size()));
    tool.report("loose_particles", std::int64_t(frames.packing().size() - particles.size()));
    for (const bool last : {false, true}) {
        if (!last && chosen.size() == 1) continue;
        const Measured& of_frame = last ? measured.back() : measured.front();
        const std::string suffix = chosen.size() == 1 ? "" : last ? "_last" : "_first";
        tool.report("relative_density" + suffix, of_frame.solid / of_frame.box);
        tool.report("relative_density_hull" + suffix, of_frame.solid / of_frame.hull);
        tool.report("solid_volume" + suffix, of_frame.solid, "mm^3");
    }
    if (chosen.size() > 1) tool.report("solid_change_last", measured.back().solid / measured.front().solid - 1.0);
    tool.report_json("rows", table.json());
    constexpr double apart = 1.5;
    if (const double growth = measured.back().hull / measured.front().hull; growth > apart)
        tool.warn(fmt::format(
            "the structure comes apart: the convex hull around it is {:.2g} times as large at the end as in "
            "the first frame; its parts are too thin in particles: make the sample with fewer "
            "--pixels-per-seed",
            growth));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
