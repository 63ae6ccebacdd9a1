// local_stress: the stress of the particles of a run, averaged over their surroundings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "tools/metrics/fields/field_radius.hpp"
#include "tools/metrics/fields/run_frames.hpp"
#include "tools/metrics/fields/space_average.hpp"
#include "tools/metrics/fields/summary.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::fields;

struct Request {
    std::filesystem::path run, fields, table;
    std::string frames = "all", kernel = "ball";
    double radius = 0.0;  // mm; 0: three seed radii
    bool within_phase = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{
        "local_stress",
        "Local stress of each particle, averaged in space, with its signed equivalent stress and pressure."}
        .input("RUN", request.run, "Run (.h5) whose scene says stress = true under [output].")
        .output("FIELDS", request.fields, "Stress of each particle, to write; beside it a .xdmf for ParaView.", {".h5"})
        .option("--radius", request.radius, cli::Unit::length, cli::positive,
                "Average over the particles within this distance; the default is three seed radii.")
        .choice("--kernel", request.kernel, {"ball", "gaussian"},
                "Weight of the particles in the average: ball counts all within the radius alike; gaussian has the "
                "same width (standard deviation along an axis radius / sqrt 5, cut off at 1.5 radii).")
        .flag("--within-phase", request.within_phase, "Average each phase over its own particles only.")
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .output_option("--table", request.table,
                       "Also write the means over all particles and over each phase, with rows for each frame.",
                       {".csv"})
        .step(cli::Step::measure)
        .threads()
        .example("local_stress run.h5 stress.h5 --radius 1.5mm --table stress.csv");
}

/// The macroscopic stress at a frame, over the same window as the stress of the particles.
double macroscopic_stress(const RunReader& run, std::size_t index) {
    const auto stress = run.observables().find("stress_true");
    return stress == run.observables().end() ? std::numeric_limits<double>::quiet_NaN()
                                             : value_at(stress->second, run.frame_time(index));
}

void run(const Request& request, cli::Tool& tool) {
    const RunFrames frames(request.run);
    const std::vector<std::size_t> chosen = cli::chosen_frames(request.frames, frames.run().frame_count());
    const RunReader& run = frames.run();
    const Packing& packing = frames.packing();
    const auto has_stress = [](const ParticleField& field) { return field.name == "stress" && field.components == 6; };
    if (std::none_of(run.fields().begin(), run.fields().end(), has_stress))
        throw InvalidInput(
            fmt::format("'{}' holds no stress of its particles: write `stress = true` under [output] in the scene and "
                        "run solve again",
                        request.run.string()));
    const double radius = tool.given("--radius") ? request.radius : default_field_radius(packing.seed_radius);
    require_smaller_than_sample(radius, packing);
    const SpaceAverage average{.kernel = request.kernel == "ball" ? Kernel::ball : Kernel::gaussian,
                               .radius = radius,
                               .species = request.within_phase ? std::span<const std::int32_t>(packing.species)
                                                               : std::span<const std::int32_t>()};

    const std::vector<std::pair<std::string, double>> attributes{{"averaging_radius", radius}};
    FieldWriter writer(run, chosen,
                       {{"stress_average", "Pa", 6, attributes},
                        {"stress_equivalent", "Pa", 1, attributes},
                        {"pressure", "Pa", 1, attributes}},
                       request.fields, provenance_of_fields(run, tool.provenance()));
    Table table(
        RunFrames::columns({"species [-]", "particles [-]", "stress_xx [Pa]", "stress_yy [Pa]", "stress_zz [Pa]",
                            "stress_xy [Pa]", "stress_xz [Pa]", "stress_yz [Pa]", "pressure [Pa]",
                            "stress_equivalent [Pa]", "stress_equivalent_deviation [Pa]", "stress_equivalent_min [Pa]",
                            "stress_equivalent_max [Pa]", "stress_axial_of_particles [Pa]", "stress_true [Pa]"}));
    Summary last_equivalent, last_pressure;
    std::size_t with_stress = 0;
    const auto progress = tool.progress("frames", double(chosen.size()));
    for (std::size_t done = 0; done < chosen.size(); ++done) {
        const std::size_t index = chosen[done];
        const Frame frame = run.frame(index);
        const std::vector<double> stress = run.field_values("stress", index);
        const bool known = std::any_of(stress.begin(), stress.end(), [](double s) { return std::isfinite(s); });
        const std::vector<double> mean =
            known ? averaged_in_space(frame.position, frames.box(index), stress, 6, average, tool.threads()) : stress;
        std::vector<double> equivalent(packing.size()), pressures(packing.size());
        for (std::size_t i = 0; i < packing.size(); ++i) {
            const std::span<const double, 6> tensor(mean.data() + 6 * i, 6);
            equivalent[i] = signed_equivalent(tensor);
            pressures[i] = pressure(tensor);
        }
        if (known) {
            ++with_stress;
            last_equivalent = summary({equivalent}, packing.species);
            last_pressure = summary({pressures}, packing.species);
            const auto add = [&](std::optional<std::int32_t> label) {
                const Summary of_equivalent = summary({equivalent}, packing.species, label);
                std::vector<Table::Cell> cells{label_cell(label), of_equivalent.count};
                for (std::size_t k = 0; k < 6; ++k)
                    cells.push_back(number(summary({mean, 6, k}, packing.species, label).mean));
                const auto axis = std::size_t(frames.axis());
                for (const double value :
                     {summary({pressures}, packing.species, label).mean, of_equivalent.mean, of_equivalent.deviation,
                      of_equivalent.min, of_equivalent.max, summary({stress, 6, axis}, packing.species, label).mean,
                      label ? std::numeric_limits<double>::quiet_NaN() : macroscopic_stress(run, index)})
                    cells.push_back(number(value));
                table.add(frames.row(index, cells));
            };
            add({});
            if (frames.labels().size() > 1)
                for (const std::int32_t label : frames.labels()) add(label);
        }
        writer.add_frame(frame, {mean, equivalent, pressures});
        progress->update(double(done + 1));
    }
    if (with_stress == 0)
        throw InvalidInput(fmt::format("'{}': no chosen frame has a stress; the first frame of a run never has one",
                                       request.run.string()));
    writer.commit();
    if (!request.table.empty()) table.write(request.table);

    tool.report("frames", std::int64_t(chosen.size()));
    tool.report("frames_with_stress", std::int64_t(with_stress));
    tool.report("particles", std::int64_t(packing.size()));
    tool.report("radius", radius, "mm");
    tool.report("stress_equivalent_last", last_equivalent.mean, "Pa");
    tool.report("stress_equivalent_deviation_last", last_equivalent.deviation, "Pa");
    tool.report("pressure_last", last_pressure.mean, "Pa");
    tool.report_json("rows", table.json());
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
