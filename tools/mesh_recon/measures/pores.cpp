// pores: volume, surface, mouths and sphericity of the pores of a sample through a run, by one of three methods.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/law/self_contact.hpp"
#include "core/packing/packing_file.hpp"
#include "core/surface/filling.hpp"
#include "core/surface/pore_search.hpp"
#include "core/surface/reconstruction.hpp"
#include "tools/metrics/curves/strain_curves.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;
namespace fs = std::filesystem;

struct Request {
    fs::path run, table, each;
    std::string method = "lids", frames = "all";
    double probe_radius = 0.0, lid_radius = 0.0, min_outward = 0.0;  // mm; 0: not given
    double min_pore = 4.0;
    std::int64_t closed_frame = -1;
    bool closed_only = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"pores", "Volume, surface, mouths and sphericity of the pores of a sample through a run."}
        .input("RUN", request.run, "Run or sample (.h5) to measure.")
        .output("TABLE", request.table, "Table to write, with one row for each frame.", {".csv"})
        .output_option("--each", request.each,
                       "Also write one row for each pore and frame; a pore keeps its number from frame to frame.",
                       {".csv"})
        .choice("--method", request.method, {"lids", "two-probes", "outward-vectors"},
                "Method to find the pores: lids closes their mouths; two-probes and outward-vectors are the methods of "
                "the thesis, for comparison.")
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "Take as a pore the space where a ball of this radius fits between the centres; the default is 1 "
                "particle diameter with lids, 0.9 with two-probes and 2 with outward-vectors.")
        .option(
            "--lid-radius", request.lid_radius, cli::Unit::length, cli::positive,
            "Close the mouth of a pore that a ball of this radius cannot enter from outside. The default is half of "
            "the sample's shortest edge in the first frame; for an open structure (less than half solid) it is ten "
            "times its longest edge, nearly the convex hull. With two-probes, it is the radius of the large probe; the "
            "default is five particle diameters.")
        .flag("--closed-only", request.closed_only,
              "Measure only closed pores, those without an opening to the outside of the sample.")
        .option("--min-pore", request.min_pore, cli::Unit::none, cli::not_negative,
                "Leave out pores of less than the volume of this many particles.")
        .option("--closed-frame", request.closed_frame, cli::Unit::none, {.low = 0},
                "With two-probes, subtract the difference of this frame, in which all pores are closed.")
        .option("--min-outward", request.min_outward, cli::Unit::length, cli::positive,
                "With --method outward-vectors, length from which the outward vector of a particle (minus the sum of "
                "the vectors to its neighbours) marks it as next to a pore; the default is 4.6 seed radii.")
        .exclusive({"--closed-only", "--lid-radius"})
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Pores",
                  .results = {{"porosity_last", "porosity", "%", 100},
                              {"porosity_first", "porosity, first frame", "%", 100},
                              {"porosity", "porosity", "%", 100},
                              {"pores_last", "pores", ""},
                              {"pores", "pores", ""},
                              {"open_pores_last", "pores with a mouth", ""},
                              {"open_pores", "pores with a mouth", ""},
                              {"volume_corrected_last", "volume of the pores", "mm³"},
                              {"volume_corrected", "volume of the pores", "mm³"},
                              {"lid_radius", "radius of the ball whose surface is the lid", "mm"}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"porosity", "porosity", "%", 100}}})
        .example("pores run.h5 pores.csv --each each_pore.csv")
        .example("pores run.h5 two_probes.csv --method two-probes --closed-frame 12");
}

/// The lid of all frames, and the particles that it lies over.
struct LidOfRun {
    double radius = 0.0;  ///< [mm]; 0: none
    bool open_structure = false;
    std::vector<std::int32_t> particles{};  ///< of an open structure, those that have not come loose; empty: all
};

/// Chosen from the first frame, so that it does not jump where the sample changes its shape.
LidOfRun lid_of_run(const Request& request, const RunReader& reader, cli::Tool& tool) {
    if (request.closed_only || request.method == "two-probes") return {};
    if (tool.given("--lid-radius")) return {.radius = request.lid_radius};
    const Packing& first = reader.packing();
    if (request.method == "lids") {
        LidOfRun lid;
        lid.particles =
            without_loose(reader.frame(reader.frame_count() - 1).position, first.seed_radius, tool.threads());
        const std::vector<Vec3> centres = centres_of(first.position, lid.particles);
        lid.open_structure = is_open(filling_of(centres, first.seed_radius));
        if (lid.open_structure) {
            lid.radius = default_lid_radius(centres, true);
            return lid;
        }
    }
    return {.radius = default_lid_radius(first.position, false)};
}

/// What the method says of one frame.
struct Measure {
    Pores pores{};
    double difference = 0.0;  // of two probes [mm^3]
    double box = 0.0;         // the smallest around the centres [mm^3]
};

Table::Cell cell(double value) {
    if (std::isnan(value)) return std::monostate{};
    return value;
}

/// By volume; not a number without pores.
double mean_sphericity(const Pores& pores) {
    double sum = 0.0;
    for (const Pore& pore : pores.pores) sum += pore.body.volume * pore.sphericity();
    return sum / pores.volume();
}

/// A probe that passes between the particles of a dense packing makes pores of its gaps.
void check_probe(double probe_radius, double seed_radius) {
    const double diameters = probe_radius / default_probe_radius(seed_radius);
    if (diameters < 0.75)
        throw InvalidInput(
            fmt::format("--probe-radius {:g} mm is {:.2g} particle diameters: that passes between the particles of a "
                        "dense packing, whose gaps are no pores; give 0.9 ({:g} mm) or more",
                        probe_radius, diameters, 0.9 * default_probe_radius(seed_radius)));
}

double box_volume(const std::vector<Vec3>& centres) {
    Vec3 low = centres.front(), high = low;
    for (const Vec3& centre : centres) low = low.cwiseMin(centre), high = high.cwiseMax(centre);
    return (high - low).prod();
}

/// The volume of the pores can change by what the box of the sample changes, and by the work of the flow within it. A
/// tenth of the box is more than any of the latter between two frames; a lid that falls through a gap, or closes over
/// one, moves more.
void warn_of_jumps(const std::vector<std::size_t>& frames, const std::vector<Measure>& measures, double lid_radius,
                   cli::Tool& tool) {
    for (std::size_t k = 1; k < measures.size(); ++k) {
        const Measure &before = measures[k - 1], &now = measures[k];
        const double change = std::abs(now.pores.volume() - before.pores.volume());
        if (change <= std::abs(now.box - before.box) + 0.1 * std::max(now.box, before.box)) continue;
        tool.warn(fmt::format(
            "between frames {} and {} the volume of the pores goes from {:.3g} to {:.3g} mm^3, more than the strain "
            "between them can explain: a ball of {:.3g} mm enters the structure in one of them and not in the other; "
            "give a larger --lid-radius, or measure relative_density, which needs no lid",
            frames[k - 1], frames[k], before.pores.volume(), now.pores.volume(), lid_radius));
        return;
    }
}

Measure measure(const Request& request, const RunReader& reader, std::size_t index, double probe_radius,
                const LidOfRun& lid, cli::Tool& tool) {
    const Packing& packing = reader.packing();
    const Frame frame = reader.frame(index);
    const std::vector<Vec3> centres =
        lid.particles.empty() ? frame.position : centres_of(frame.position, lid.particles);
    require_smaller_probe(centres, probe_radius);
    Measure result{.box = box_volume(centres)};
    if (request.method == "two-probes") {
        result.difference = probe_difference(
            centres, probe_radius, tool.given("--lid-radius") ? request.lid_radius : 10.0 * packing.seed_radius);
        return result;
    }
    const PoreSearch search{.probe_radius = probe_radius,
                            .seed_radius = packing.seed_radius,
                            .lid_radius = lid.radius,
                            .open_structure = lid.open_structure};
    if (request.method == "lids") {
        result.pores = find_pores(centres, search);
    } else {
        const double min_outward = tool.given("--min-outward")
                                       ? request.min_outward
                                       : law::SelfContact::outward_over_seed * packing.seed_radius;
        const double reach = law::SelfContact::crown_over_seed * packing.seed_radius;
        result.pores = pores_by_outward_vectors(centres, outward_vectors(centres, reach), min_outward, search);
    }
    result.pores.leave_out_below(request.min_pore * result.pores.solid / double(centres.size()));
    return result;
}

void check(const Request& request, cli::Tool& tool) {
    const auto only_with = [&](const char* flag, const char* method) {
        if (tool.given(flag) && request.method != method)
            throw WrongUsage(fmt::format("{} goes with --method {} only", flag, method));
    };
    only_with("--closed-frame", "two-probes");
    only_with("--min-outward", "outward-vectors");
    only_with("--closed-only", "lids");
    if (request.method == "two-probes" && tool.given("--each"))
        throw WrongUsage("--each: two-probes gives one volume for all pores; take another --method");
}

std::size_t checked_frame(std::int64_t frame, const RunReader& reader) {
    if (frame >= std::int64_t(reader.frame_count()))
        throw InvalidInput(
            fmt::format("--closed-frame {}: the run has frames 0 to {}", frame, reader.frame_count() - 1));
    return std::size_t(frame);
}

void run(const Request& request, cli::Tool& tool) {
    check(request, tool);
    const RunReader reader(request.run);
    const double seed_radius = reader.packing().seed_radius;
    const bool two_probes = request.method == "two-probes";
    const double probe_radius = tool.given("--probe-radius") ? request.probe_radius
                                : two_probes                 ? 1.8 * seed_radius
                                : request.method == "lids"   ? default_probe_radius(seed_radius)
                                                             : 2.0 * default_probe_radius(seed_radius);
    check_probe(probe_radius, seed_radius);
    std::optional<std::size_t> closed;
    if (tool.given("--closed-frame")) closed = checked_frame(request.closed_frame, reader);

    const std::vector<std::size_t> frames = cli::chosen_frames(request.frames, reader.frame_count());
    const LidOfRun lid = lid_of_run(request, reader, tool);
    const std::size_t count = frames.size();
    const auto progress = tool.progress("frames", double(count));
    std::vector<Measure> measures(count);
    std::mutex mutex;
    std::size_t done = 0;
    parallel_for(std::int64_t(count), tool.threads(), [&](std::int64_t k) {
        const std::size_t frame = frames[std::size_t(k)];
        try {
            measures[std::size_t(k)] = measure(request, reader, frame, probe_radius, lid, tool);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("frame {}: {}", frame, error.what()));
        }
        const std::scoped_lock lock(mutex);
        progress->update(double(++done));
    });
    const double reference = closed ? measure(request, reader, *closed, probe_radius, lid, tool).difference : 0.0;

    Table table({"frame [-]", "time [s]", "strain [-]", "abs_strain [-]", "pores [-]", "open_pores [-]",
                 "volume [mm^3]", "volume_corrected [mm^3]", "porosity [-]", "mouth_area [mm^2]", "largest [mm^3]",
                 "sphericity [-]"});
    Table each({"frame [-]", "time [s]", "strain [-]", "abs_strain [-]", "pore [-]", "particles [-]", "volume [mm^3]",
                "volume_corrected [mm^3]", "area [mm^2]", "mouth_area [mm^2]", "sphericity [-]", "centre_x [mm]",
                "centre_y [mm]", "centre_z [mm]", "genus [-]", "shells [-]"});
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    std::vector<std::int64_t> numbers;
    std::int64_t next_number = 1;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t frame = frames[k];
        const double time = reader.frame_time(frame), strain = frame_strain(reader, frame);
        const Pores& pores = measures[k].pores;
        std::int64_t open = 0;
        for (const Pore& pore : pores.pores) open += pore.mouth > 0.0;
        const double volume = two_probes ? measures[k].difference - reference : pores.volume();
        const double corrected = two_probes ? std::nan("") : pores.corrected_volume();
        const double porosity = pores.solid > 0.0 ? corrected / (corrected + pores.solid) : std::nan("");
        const double largest = pores.pores.empty() ? 0.0 : pores.pores.front().body.volume;
        table.add({std::int64_t(frame), time, strain, std::abs(strain),
                   two_probes ? Table::Cell() : Table::Cell(std::int64_t(pores.pores.size())),
                   two_probes ? Table::Cell() : Table::Cell(open), volume, cell(corrected), cell(porosity),
                   two_probes ? Table::Cell() : Table::Cell(pores.mouth()),
                   two_probes ? Table::Cell() : Table::Cell(largest), cell(mean_sphericity(pores))});
        rows.push_back({{"frame", frame},
                        {"strain", strain},
                        {"pores", pores.pores.size()},
                        {"open_pores", open},
                        {"volume", volume},
                        {"volume_corrected", corrected},
                        {"porosity", porosity},
                        {"mouth_area", pores.mouth()}});
        numbers = lasting_numbers(pores, k > 0 ? measures[k - 1].pores : Pores{}, numbers, next_number);
        for (std::size_t i = 0; i < pores.pores.size(); ++i) {
            const auto& [body, mouth, around] = pores.pores[i];
            each.add({std::int64_t(frame), time, strain, std::abs(strain), numbers[i], body.particles, body.volume,
                      cell(body.corrected_volume), body.area, mouth, pores.pores[i].sphericity(), body.centre.x(),
                      body.centre.y(), body.centre.z(), body.genus, body.shells});
        }
    }
    table.write(request.table);
    if (tool.given("--each")) each.write(request.each);

    tool.report("frames", std::int64_t(count));
    tool.report("probe_radius", probe_radius, "mm");
    if (lid.radius > 0.0) {
        tool.report("lid_radius", lid.radius, "mm");
        tool.report("lid", std::string(tool.given("--lid-radius") ? "given"
                                       : lid.open_structure       ? "convex hull"
                                                                  : "half of the shortest edge in the first frame"));
        if (lid.open_structure)
            tool.report("loose_particles", std::int64_t(reader.packing().size() - lid.particles.size()));
    }
    for (const bool last : {false, true}) {
        if (!last && count == 1) continue;
        const nlohmann::ordered_json& row = last ? rows.back() : rows.front();
        const std::string suffix = count == 1 ? "" : last ? "_last" : "_first";
        if (!two_probes) {
            tool.report("pores" + suffix, row["pores"].get<std::int64_t>());
            tool.report("open_pores" + suffix, row["open_pores"].get<std::int64_t>());
        }
        tool.report("volume" + suffix, row["volume"].get<double>(), "mm^3");
        if (const double corrected = row["volume_corrected"].get<double>(); !std::isnan(corrected))
            tool.report("volume_corrected" + suffix, corrected, "mm^3");
        if (const double porosity = row["porosity"].get<double>(); !std::isnan(porosity))
            tool.report("porosity" + suffix, porosity);
    }
    tool.report_json("frame_rows", rows);
    if (request.method == "lids" && lid.radius > 0.0) warn_of_jumps(frames, measures, lid.radius, tool);
    if (request.method == "lids" && std::abs(probe_radius / default_probe_radius(seed_radius) - 1.0) > 0.05)
        tool.warn(
            "the corrected volumes and the porosity are calibrated for a probe of one particle diameter; a smaller one "
            "may "
            "take gaps for pores");
    if (two_probes && !closed)
        tool.warn("the volume of two-probes includes the roughness of the outside; give --closed-frame to subtract it");
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
