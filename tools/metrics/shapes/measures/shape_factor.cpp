// shape_factor: S_f = H / D of every object at every frame of a run.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path run, table, means;
    std::int64_t min_particles = 20;
    bool exclude_boundary = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"shape_factor",
                      "Shape factor S_f = H / D of the objects of a run, H along the load and D across."}
        .input("RUN", request.run, "Run or sample (.h5) whose particles carry the number of their object.")
        .output("TABLE", request.table, "Table to write, with one row for each frame and object.", {".csv"})
        .option("--min-particles", request.min_particles, cli::Unit::particles, {.low = 4},
                "Leave out objects with fewer particles.")
        .flag("--exclude-boundary", request.exclude_boundary,
              "Leave out objects within one particle diameter of the sample's outer box in the first frame.")
        .output_option("--means", request.means, "Also write the means over the objects, with one row for each frame.",
                       {".csv"})
        .step(cli::Step::measure)
        .measure({.heading = "Shape factor",
                  .results = {{"shape_factor_last", "shape factor H/D, mean by volume at the end", ""},
                              {"shape_factor_last_deviation", "scatter of the objects", ""},
                              {"shape_factor_first", "shape factor H/D, at the beginning", ""},
                              {"objects_used", "objects measured", ""},
                              {"objects_too_small", "objects too small", ""},
                              {"objects_at_boundary", "objects left out at the outer faces", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"shape_factor", "shape factor H/D", ""}}})
        .example("shape_factor run.h5 shapes.csv --means means.csv --exclude-boundary");
}

/// A number of JSON, or null.
std::string json(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : "null";
}

Table::Cell cell(const std::optional<double>& value) {
    return value ? Table::Cell(*value) : Table::Cell();
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.run);
    const int axis = load_axis(reader, request.run);
    const Packing& packing = reader.packing();
    const ChosenObjects objects = choose_objects(
        packing, {.min_particles = std::size_t(request.min_particles), .exclude_boundary = request.exclude_boundary});
    const double volume_per_particle = packing.box.volume() / double(packing.size());

    Table table({"frame [-]", "time [s]", "strain [-]", "abs_strain [-]", "object [-]", "species [-]", "particles [-]",
                 "shape_factor [-]", "shape_factor_normalised [-]", "volume_estimate [mm^3]"});
    Table means({"frame [-]", "time [s]", "strain [-]", "abs_strain [-]", "objects [-]", "shape_factor_weighted [-]",
                 "deviation_weighted [-]", "shape_factor_plain [-]", "deviation_plain [-]", "normalised_weighted [-]",
                 "normalised_deviation_weighted [-]", "normalised_plain [-]", "normalised_deviation_plain [-]"});
    std::vector<double> first, weights;
    for (const Object& object : objects.used) {
        first.push_back(shape_factor(second_moments(packing.position, object.members), axis));
        weights.push_back(double(object.members.size()));
    }

    const auto progress = tool.progress("frames", double(reader.frame_count()));
    std::string frames;
    Spread weighted_first, weighted, plain, weighted_normalised;
    for (std::size_t index = 0; index < reader.frame_count(); ++index) {
        const Frame frame = reader.frame(index);
        const double strain = frame_strain(reader, index);
        std::vector<double> factors, normalised;
        for (std::size_t k = 0; k < objects.used.size(); ++k) {
            const Object& object = objects.used[k];
            factors.push_back(shape_factor(second_moments(frame.position, object.members), axis));
            normalised.push_back(factors[k] / first[k]);
            table.add({std::int64_t(index), frame.time, strain, std::abs(strain), std::int64_t(object.number),
                       std::int64_t(object.species), std::int64_t(object.members.size()), factors[k], normalised[k],
                       weights[k] * volume_per_particle});
        }
        weighted = weighted_spread(factors, weights);
        plain = plain_spread(factors);
        weighted_normalised = weighted_spread(normalised, weights);
        const Spread plain_normalised = plain_spread(normalised);
        if (index == 0) weighted_first = weighted;
        means.add({std::int64_t(index), frame.time, strain, std::abs(strain), std::int64_t(factors.size()),
                   weighted.mean, cell(weighted.deviation), plain.mean, cell(plain.deviation), weighted_normalised.mean,
                   cell(weighted_normalised.deviation), plain_normalised.mean, cell(plain_normalised.deviation)});
        frames +=
            fmt::format(R"({}{{"frame":{},"strain":{},"mean_weighted":{},"deviation_weighted":{},"mean_plain":{},)"
                        R"("deviation_plain":{},"normalised_mean_weighted":{},"normalised_mean_plain":{}}})",
                        index == 0 ? "" : ",", index, strain, weighted.mean, json(weighted.deviation), plain.mean,
                        json(plain.deviation), weighted_normalised.mean, plain_normalised.mean);
        progress->update(double(index + 1));
    }

    table.write(request.table);
    if (!request.means.empty()) means.write(request.means);
    tool.report("frames", std::int64_t(reader.frame_count()));
    tool.report("objects_used", std::int64_t(objects.used.size()));
    tool.report("objects_too_small", std::int64_t(objects.too_small));
    if (request.exclude_boundary) tool.report("objects_at_boundary", std::int64_t(objects.at_boundary));
    tool.report("shape_factor_first", weighted_first.mean);
    tool.report("shape_factor_last", weighted.mean);
    if (weighted.deviation) tool.report("shape_factor_last_deviation", *weighted.deviation);
    tool.report("shape_factor_last_plain", plain.mean);
    if (plain.deviation) tool.report("shape_factor_last_plain_deviation", *plain.deviation);
    tool.report("shape_factor_last_normalised", weighted_normalised.mean);
    tool.report_json("shape_factor_frames", nlohmann::ordered_json::parse("[" + frames + "]"));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
