// image_shapes: the ellipsoid of every object, or every closed pore, of a label image.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/volume/regions.hpp"
#include "tools/metrics/shapes/image_shapes.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::shapes;

struct Request {
    VolumeRequest volume;
    std::filesystem::path table;
    std::string objects, label_objects;
    bool pores = false;
    std::string connectivity = "6", axis = "z";
    std::int64_t min_voxels = 27;
    bool exclude_boundary = false;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("image_shapes",
                     "Centre, volume, ellipsoid of inertia, shape factor and surface of the objects or pores of a "
                     "segmented tomography.");
    add_volume(usage, request.volume)
        .output("TABLE", request.table, "Table to write, with one row for each object or pore.", {".csv"})
        .option("--objects", request.objects,
                "Measure each connected component of these labels as an object, as 2,3; all takes every label but 0.")
        .option(
            "--label-objects", request.label_objects,
            "Measure each of these labels as one object (watershed); 2:500=1 takes the labels 2 to 500 as objects of "
            "label 1 in the sample.")
        .flag("--pores", request.pores,
              "Measure the closed pores: connected components of the void that reach no face of the image.")
        .exclusive({"--objects", "--pores"})
        .exclusive({"--label-objects", "--pores"})
        .choice("--connectivity", request.connectivity, {"6", "18", "26"},
                "Connect a voxel with its neighbours across faces (6), also across edges (18), also across corners "
                "(26).")
        .choice("--axis", request.axis, {"x", "y", "z"}, "Take the height H of the shape factor H / D along this axis.")
        .option("--min-voxels", request.min_voxels, cli::Unit::voxels, cli::positive,
                "Leave out objects and pores with fewer voxels.")
        .flag("--exclude-boundary", request.exclude_boundary, "Leave out objects that touch a face of the image.")
        .step(cli::Step::measure)
        .example("image_shapes stack/ nodules.csv --voxel-size 3um --objects 1 --connectivity 26")
        .example("image_shapes pores.tif pores.csv --pores --json pores.json");
    return usage;
}

ObjectLabels parse_objects(const Request& request) {
    ObjectLabels objects{.all_components = request.objects == "all",
                         .connectivity = connectivity_of(request.connectivity)};
    if (!objects.all_components && !request.objects.empty())
        objects.components = parse_labels("--objects", request.objects);
    if (!request.label_objects.empty()) objects.labels = parse_label_objects("--label-objects", request.label_objects);
    return objects;
}

void write_table(const std::vector<ImageBody>& bodies, const std::filesystem::path& path) {
    std::vector<std::string> columns{"object [-]", "label [-]", "voxels [-]", "at_boundary [-]"};
    for (const std::string& column : shape_columns()) columns.push_back(column);
    columns.push_back("area [mm^2]");
    columns.push_back("sphericity [-]");
    Table table(columns);
    for (const ImageBody& body : bodies) {
        std::vector<Table::Cell> row{std::int64_t(body.number), std::int64_t(body.label), body.voxels,
                                     std::int64_t(body.at_boundary)};
        append_cells(body.shape, row);
        row.emplace_back(body.area);
        if (body.area > 0.0)
            row.emplace_back(body.sphericity);
        else
            row.emplace_back();
        table.add(std::move(row));
    }
    table.write(path);
}

void report_bodies(const std::vector<ImageBody>& bodies, cli::Tool& tool) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    std::vector<double> factors, volumes;
    double volume = 0.0;
    for (const ImageBody& body : bodies) {
        nlohmann::ordered_json& row = rows.emplace_back();
        row = {
            {"object", body.number}, {"label", body.label}, {"voxels", body.voxels}, {"at_boundary", body.at_boundary}};
        append_json(body.shape, row);
        row["area"] = body.area;
        row["sphericity"] = body.area > 0.0 ? nlohmann::ordered_json(body.sphericity) : nullptr;
        volume += body.shape.volume;
        factors.push_back(body.shape.shape_factor);
        volumes.push_back(body.shape.volume);
    }
    tool.report("volume", volume, "mm^3");
    if (!bodies.empty()) tool.report("shape_factor_weighted", weighted_spread(factors, volumes).mean);
    tool.report_json("shapes", rows);
}

void run(const Request& request, cli::Tool& tool) {
    if (!request.pores && request.objects.empty() && request.label_objects.empty())
        throw WrongUsage("say what to measure: --objects, --label-objects or --pores");
    if (request.pores && request.exclude_boundary)
        throw WrongUsage("--exclude-boundary belongs to objects: a pore at a face of the image is not closed");
    const ObjectLabels objects = parse_objects(request);
    LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const BodyChoice choice{request.min_voxels, request.exclude_boundary, int(request.axis[0] - 'x')};
    if (request.pores) {
        const VoidParts parts = void_parts(volume, objects.connectivity, choice);
        write_table(parts.closed, request.table);
        if (parts.closed.empty()) tool.warn("there is no closed pore: the table is empty");
        const double closed = double(parts.closed_voxels), open = double(parts.open_voxels), all = double(parts.voxels);
        tool.report("pores", std::int64_t(parts.closed.size()));
        tool.report("pores_too_small", parts.too_small);
        tool.report("pores_open", parts.open);
        tool.report("closed_porosity", 100.0 * closed / (all - open), "%");
        tool.report("void_at_faces", 100.0 * open / all, "%");
        report_bodies(parts.closed, tool);
        return;
    }
    const ImageObjects measured = image_objects(volume, objects, choice);
    write_table(measured.used, request.table);
    tool.report("objects_used", std::int64_t(measured.used.size()));
    tool.report("objects_too_small", measured.too_small);
    if (request.exclude_boundary) tool.report("objects_at_boundary", measured.at_boundary);
    report_bodies(measured.used, tool);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
