// topology: parts, handles and pores of a sample through the frames of a run, and the events that change them.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "core/surface/reconstruction.hpp"
#include "core/surface/selection.hpp"
#include "tools/mesh_recon/topology.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::mesh_recon;
namespace fs = std::filesystem;

struct Request {
    fs::path run, table, events;
    double probe_radius = 0.0;  // mm; 0: one particle diameter
    std::int64_t species = 0, min_particles = 20;
    double min_pore = 4.0;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"topology",
                      "Numbers of separate parts, handles (holes right through a part) and closed pores through a run, "
                      "and the events that change them, such as merging and splitting."}
        .input("RUN", request.run, "Run (.h5) to measure.")
        .output("TABLE", request.table, "Table to write, with one row for each frame.", {".csv"})
        .output_option("--events", request.events, "Also write one row for each event.", {".csv"})
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "Fill the gaps between centres that a ball of this radius cannot enter; the default is one particle "
                "diameter.")
        .option("--species", request.species, cli::Unit::none, cli::positive, "Measure only the phase of this label.")
        .option("--min-particles", request.min_particles, cli::Unit::particles, {.low = 4},
                "Count parts of fewer particles, but do not follow them from frame to frame.")
        .option("--min-pore", request.min_pore, cli::Unit::none, cli::not_negative,
                "Count pores of less than the volume of this many particles, but do not follow them from frame to "
                "frame.")
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Parts, handles and pores",
                  .results = {{"b0_first", "parts, first frame", ""},
                              {"b0_last", "parts, last frame", ""},
                              {"b1_first", "handles, first frame", ""},
                              {"b1_last", "handles, last frame", ""},
                              {"b2_first", "closed pores, first frame", ""},
                              {"b2_last", "closed pores, last frame", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"b0", "parts", ""}, {"b1", "handles", ""}, {"b2", "closed pores", ""}}})
        .example("topology run.h5 topology.csv --events events.csv");
}

struct When {
    double time, strain;
};

/// The strain is not a number where the run has no such curve.
When when(const RunReader& run, std::size_t frame) {
    const auto strain = run.observables().find("strain");
    const double time = run.frame_time(frame);
    return {time, strain == run.observables().end() || strain->second.value.empty() ? std::nan("")
                                                                                    : value_at(strain->second, time)};
}

Table::Cell number_or_empty(double value) {
    if (std::isnan(value)) return std::monostate{};
    return value;
}

/// Numbers from 1, as mesh_recon --bodies gives them where nothing is too small to be followed.
std::string numbers(const std::vector<std::int32_t>& list) {
    std::string text;
    for (const std::int32_t number : list) {
        if (!text.empty()) text += '+';
        text += std::to_string(number + 1);
    }
    return text;
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.run);
    const Packing& packing = reader.packing();
    const std::size_t frames = reader.frame_count();
    Selection selection;
    if (tool.given("--species")) selection.species = request.species;
    const double probe_radius =
        tool.given("--probe-radius") ? request.probe_radius : default_probe_radius(packing.seed_radius);
    const auto centres_at = [&](std::size_t frame) {
        Packing moved = packing;
        moved.position = reader.frame(frame).position;
        return selected_centres(moved, selection);
    };

    const auto progress = tool.progress("alpha shapes", double(frames));
    std::vector<FrameTopology> topology(frames);
    std::mutex mutex;
    std::size_t done = 0;
    parallel_for(std::int64_t(frames), tool.threads(), [&](std::int64_t frame) {
        const std::vector<Vec3> centres = centres_at(frame);
        try {
            require_smaller_probe(centres, probe_radius);
            topology[frame] = frame_topology(
                alpha_surface(centres,
                              {.probe_radius = probe_radius, .progress = {}, .seed_radius = packing.seed_radius}),
                {.particles = request.min_particles, .pore = request.min_pore});
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("frame {}: {}", frame, error.what()));
        }
        const std::scoped_lock lock(mutex);
        progress->update(double(++done));
    });

    Table table({"frame [-]", "time [s]", "strain [-]", "b0 [-]", "b1 [-]", "b2 [-]", "parts [-]", "pores [-]",
                 "volume [mm^3]", "pore_volume [mm^3]"});
    for (std::size_t i = 0; i < frames; ++i) {
        const FrameTopology& frame = topology[i];
        const auto [time, strain] = when(reader, i);
        table.add({std::int64_t(i), time, number_or_empty(strain), frame.b0, frame.b1, frame.b2,
                   std::int64_t(frame.parts.size()), std::int64_t(frame.pores.size()), frame.volume,
                   frame.pore_volume});
    }
    Table events({"event [-]", "frame [-]", "time [s]", "strain_before [-]", "strain [-]", "x [mm]", "y [mm]", "z [mm]",
                  "volume [mm^3]", "before [-]", "after [-]"});
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    std::map<std::string, std::int64_t> counts;
    std::vector<Vec3> before = centres_at(0);
    for (std::size_t i = 1; i < frames; ++i) {
        std::vector<Vec3> after = centres_at(i);
        const auto [time, strain] = when(reader, i);
        const double strain_before = when(reader, i - 1).strain;
        for (const Event& event : events_between(topology[i - 1], topology[i], before, after, 2.0 * probe_radius)) {
            const std::string name = name_of(event.change);
            ++counts[name];
            events.add({name, std::int64_t(i), time, number_or_empty(strain_before), number_or_empty(strain),
                        event.place.x(), event.place.y(), event.place.z(), event.volume, numbers(event.before),
                        numbers(event.after)});
            json.push_back({{"event", name},
                            {"frame", i},
                            {"time", time},
                            {"strain_before", strain_before},
                            {"strain", strain},
                            {"place", {event.place.x(), event.place.y(), event.place.z()}},
                            {"volume", event.volume},
                            {"before", numbers(event.before)},
                            {"after", numbers(event.after)}});
        }
        before = std::move(after);
    }
    table.write(request.table);
    if (tool.given("--events")) events.write(request.events);

    tool.report("frames", std::int64_t(frames));
    tool.report("probe_radius", probe_radius, "mm");
    for (const char* which : {"first", "last"}) {
        const FrameTopology& frame = which[0] == 'f' ? topology.front() : topology.back();
        tool.report(fmt::format("b0_{}", which), frame.b0);
        tool.report(fmt::format("b1_{}", which), frame.b1);
        tool.report(fmt::format("b2_{}", which), frame.b2);
    }
    for (const auto& [name, count] : counts) tool.report(name, count);
    tool.report_json("events", json);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
