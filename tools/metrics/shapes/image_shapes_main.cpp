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
#include "tools/metrics/shapes/image_shapes.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"

namespace {
using namespace tomodem;

struct Request {
    VolumeRequest volume;
    std::filesystem::path table;
    ObjectLabels objects;
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
        .output("TABLE", request.table, "one row for each object or pore, to write (.csv)")
        .option("--objects", request.objects.components,
                "labels of which each connected component is an object, as 2,3; or all")
        .option("--label-objects", request.objects.labels,
                "labels of the image that are one object each, and their label in the sample, as 2:500=1 (watershed)")
        .flag("--pores", request.pores,
              "the closed pores: connected components of void that reach no face of the image")
        .exclusive({"--objects", "--pores"})
        .exclusive({"--label-objects", "--pores"})
        .choice("--connectivity", request.connectivity, {"6", "18", "26"},
                "neighbours of a voxel: by faces, by edges too, by corners too")
        .choice("--axis", request.axis, {"x", "y", "z"}, "along which the height of the shape factor is taken")
        .option("--min-voxels", request.min_voxels, cli::Unit::voxels, cli::positive,
                "objects and pores with fewer are left out")
        .flag("--exclude-boundary", request.exclude_boundary, "leave out objects that touch a face of the image")
        .example("image_shapes stack/ nodules.csv --voxel-size 3um --objects 1 --connectivity 26")
        .example("image_shapes pores.tif pores.csv --pores --json pores.json");
    return usage;
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
    std::string json;
    std::vector<double> factors, volumes;
    double volume = 0.0;
    for (const ImageBody& body : bodies) {
        const std::string sphericity = body.area > 0.0 ? fmt::format("{}", body.sphericity) : "null";
        json += fmt::format(R"({}{{"object":{},"label":{},"voxels":{},"at_boundary":{},{},"area":{},"sphericity":{}}})",
                            json.empty() ? "" : ",", body.number, body.label, body.voxels, body.at_boundary,
                            shape_json(body.shape), body.area, sphericity);
        volume += body.shape.volume;
        factors.push_back(body.shape.shape_factor);
        volumes.push_back(body.shape.volume);
    }
    tool.report("volume", volume, "mm^3");
    if (!bodies.empty()) tool.report("shape_factor_weighted", weighted_spread(factors, volumes).mean);
    tool.report_json("shapes", nlohmann::ordered_json::parse("[" + json + "]"));
}

void run(const Request& request, cli::Tool& tool) {
    if (!request.pores && request.objects.components.empty() && request.objects.labels.empty())
        throw WrongUsage("say what to measure: --objects, --label-objects or --pores");
    if (request.pores && request.exclude_boundary)
        throw WrongUsage("--exclude-boundary belongs to objects: a pore at a face of the image is not closed");
    LabelVolume volume = read_volume(request.volume, volume_options(request.volume), tool);
    const BodyChoice choice{request.min_voxels, request.exclude_boundary, int(request.axis[0] - 'x')};
    if (request.pores) {
        const VoidParts parts = void_parts(volume, connectivity_of(request.connectivity), choice);
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
    ObjectLabels objects = request.objects;
    objects.connectivity = connectivity_of(request.connectivity);
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
