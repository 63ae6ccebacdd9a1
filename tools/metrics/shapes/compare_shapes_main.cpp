// compare_shapes: the objects of a frame of a run beside those of a tomography of the same strain.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/volume/regions.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/shapes/compare_shapes.hpp"
#include "tools/metrics/shapes/voxelised_run.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;
using namespace tomodem::shapes;

struct Request {
    std::filesystem::path run, table;
    VolumeRequest volume;
    std::string frame = "last", objects, label_objects, connectivity = "6", align = "none";
    std::int64_t min_particles = 20, min_voxels = 27;
    bool exclude_boundary = false, pores = false;
};

cli::Usage usage(Request& request) {
    cli::Usage usage("compare_shapes",
                     "Compare a frame of a run with a tomography of the same strain: matched objects, their shapes, "
                     "the overlap of phases, pores.");
    usage.input("RUN", request.run,
                "Run or sample (.h5); without --pores, its particles carry the number of their object.");
    add_volume(usage, request.volume)
        .output("TABLE", request.table,
                "Table to write, with one row for each pair of objects and each object without a partner.", {".csv"})
        .option("--frame", request.frame, "Compare this frame of the run: first, last or a number from 0.")
        .option(
            "--objects", request.objects,
            "Take each connected component of these labels of the image as an object, as 2,3; all takes every label "
            "but 0.")
        .option(
            "--label-objects", request.label_objects,
            "Take each of these labels of the image as one object (watershed); 2:500=1 takes the labels 2 to 500 as "
            "objects of label 1 in the run.")
        .flag("--pores", request.pores,
              "Compare the closed pores instead: connected components of the void that reach no face of the image.")
        .exclusive({"--objects", "--pores"})
        .exclusive({"--label-objects", "--pores"})
        .choice("--connectivity", request.connectivity, {"6", "18", "26"},
                "Connect a voxel with its neighbours across faces (6), also across edges (18), also across corners "
                "(26).")
        .choice("--align", request.align, {"none", "centre"},
                "Place of the run in the image: none leaves it where it is; centre moves the mean of its particles to "
                "the centre of the image's matter.")
        .option("--min-particles", request.min_particles, cli::Unit::particles, {.low = 4},
                "Leave out objects of the run with fewer particles.")
        .option("--min-voxels", request.min_voxels, cli::Unit::voxels, cli::positive,
                "Leave out objects of the image, and pores, with fewer voxels.")
        .flag("--exclude-boundary", request.exclude_boundary,
              "Leave out objects that touch a face of the image, or lie within one particle diameter of the sample's "
              "outer box.")
        .step(cli::Step::measure)
        .example("compare_shapes run.h5 scan_07.tif compared.csv --frame 12 --objects 2 --align centre")
        .example("compare_shapes run.h5 scan_07.tif pores.csv --frame 12 --pores");
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

/// Of a pair, run against image.
struct Difference {
    Vec3 place;
    double volume, shape_factor, own_shape_factor, angle_a, angle_c;
    explicit Difference(const Match& match)
        : place(match.run->shape.centre - match.image->shape.centre),
          volume(match.run->shape.volume / match.image->shape.volume - 1.0),
          shape_factor(match.run->shape.shape_factor - match.image->shape.shape_factor),
          own_shape_factor(match.run->shape.own_shape_factor - match.image->shape.own_shape_factor),
          angle_a(axis_angle(match.run->shape.ellipsoid.direction[0], match.image->shape.ellipsoid.direction[0])),
          angle_c(axis_angle(match.run->shape.ellipsoid.direction[2], match.image->shape.ellipsoid.direction[2])) {}
};

/// Name and unit of a column, and its value in a row where it has one.
struct Column {
    const char *name, *unit;
    Table::Cell value;
};

template <class Body>
Table::Cell of(const Body* body, double Shape::*member) {
    if (!body) return {};
    return body->shape.*member;
}

template <class Body>
Table::Cell axis_of(const Body* body, int axis) {
    if (!body) return {};
    return body->shape.ellipsoid.semi_axis[axis];
}

std::vector<Column> columns_of(const Match& match) {
    const RunBody* const run = match.run;
    const ImageBody* const image = match.image;
    const std::optional<Difference> both = run && image ? std::optional<Difference>(match) : std::nullopt;
    const auto difference = [&](double Difference::*member) -> Table::Cell {
        if (!both) return {};
        return (*both).*member;
    };
    const auto whole = [](const auto* body, auto member) -> Table::Cell {
        if (!body) return {};
        return std::int64_t(body->*member);
    };
    std::vector<Column> columns{{"match", "-", std::string(name_of(match.by))},
                                {"object_run", "-", whole(run, &RunBody::number)},
                                {"object_image", "-", whole(image, &ImageBody::number)},
                                {"species", "-", whole(run, &RunBody::species)},
                                {"label", "-", whole(image, &ImageBody::label)},
                                {"particles", "-", whole(run, &RunBody::particles)},
                                {"voxels", "-", whole(image, &ImageBody::voxels)},
                                {"at_boundary_run", "-", whole(run, &RunBody::at_boundary)},
                                {"at_boundary_image", "-", whole(image, &ImageBody::at_boundary)},
                                {"dice", "-", {}},
                                {"iou", "-", {}},
                                {"distance", "mm", {}},
                                {"difference_x", "mm", {}},
                                {"difference_y", "mm", {}},
                                {"difference_z", "mm", {}}};
    if (both) {
        columns[9].value = match.dice;
        columns[10].value = match.iou;
        columns[11].value = both->place.norm();
        for (int c = 0; c < 3; ++c) columns[12 + c].value = both->place[c];
    }
    const auto centre = [](const auto* body, int c) -> Table::Cell {
        if (!body) return {};
        return body->shape.centre[c];
    };
    const std::vector<Column> rest{{"centre_x_run", "mm", centre(run, 0)},
                                   {"centre_y_run", "mm", centre(run, 1)},
                                   {"centre_z_run", "mm", centre(run, 2)},
                                   {"centre_x_image", "mm", centre(image, 0)},
                                   {"centre_y_image", "mm", centre(image, 1)},
                                   {"centre_z_image", "mm", centre(image, 2)},
                                   {"volume_run", "mm^3", of(run, &Shape::volume)},
                                   {"volume_image", "mm^3", of(image, &Shape::volume)},
                                   {"volume_difference", "-", difference(&Difference::volume)},
                                   {"shape_factor_run", "-", of(run, &Shape::shape_factor)},
                                   {"shape_factor_image", "-", of(image, &Shape::shape_factor)},
                                   {"shape_factor_difference", "-", difference(&Difference::shape_factor)},
                                   {"own_shape_factor_run", "-", of(run, &Shape::own_shape_factor)},
                                   {"own_shape_factor_image", "-", of(image, &Shape::own_shape_factor)},
                                   {"own_shape_factor_difference", "-", difference(&Difference::own_shape_factor)},
                                   {"semi_axis_a_run", "mm", axis_of(run, 0)},
                                   {"semi_axis_a_image", "mm", axis_of(image, 0)},
                                   {"semi_axis_b_run", "mm", axis_of(run, 1)},
                                   {"semi_axis_b_image", "mm", axis_of(image, 1)},
                                   {"semi_axis_c_run", "mm", axis_of(run, 2)},
                                   {"semi_axis_c_image", "mm", axis_of(image, 2)},
                                   {"angle_a", "degree", difference(&Difference::angle_a)},
                                   {"angle_c", "degree", difference(&Difference::angle_c)}};
    columns.insert(columns.end(), rest.begin(), rest.end());
    return columns;
}

struct ToJson {
    nlohmann::ordered_json operator()(std::monostate) const { return nullptr; }
    nlohmann::ordered_json operator()(double value) const { return value; }
    nlohmann::ordered_json operator()(std::int64_t value) const { return value; }
    nlohmann::ordered_json operator()(const std::string& value) const { return value; }
};

void write_pairs(const std::vector<Match>& matches, const std::filesystem::path& path, cli::Tool& tool) {
    std::vector<std::string> header;
    for (const Column& column : columns_of({})) header.push_back(fmt::format("{} [{}]", column.name, column.unit));
    Table table(header);
    nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
    for (const Match& match : matches) {
        std::vector<Table::Cell> row;
        nlohmann::ordered_json pair;
        for (const Column& column : columns_of(match)) {
            row.push_back(column.value);
            pair[column.name] = std::visit(ToJson(), column.value);
        }
        table.add(std::move(row));
        pairs.push_back(std::move(pair));
    }
    table.write(path);
    tool.report_json("pairs", pairs);
}

void report_matches(const std::vector<Match>& matches, cli::Tool& tool) {
    std::int64_t matched = 0, by_centre = 0, run_only = 0, image_only = 0;
    double factor = 0, absolute = 0, dice = 0, distance = 0, volume_run = 0, volume_image = 0, volume = 0;
    for (const Match& match : matches) {
        run_only += match.by == MatchedBy::run_only;
        image_only += match.by == MatchedBy::image_only;
        if (!match.run || !match.image) continue;
        const Difference difference(match);
        ++matched;
        by_centre += match.by == MatchedBy::centre;
        factor += difference.shape_factor;
        absolute += std::abs(difference.shape_factor);
        dice += match.dice;
        distance += difference.place.norm();
        volume += std::abs(difference.volume);
        volume_run += match.run->shape.volume;
        volume_image += match.image->shape.volume;
    }
    tool.report("objects_matched", matched);
    tool.report("objects_matched_by_centre", by_centre);
    tool.report("objects_run_only", run_only);
    tool.report("objects_image_only", image_only);
    if (matched == 0) {
        tool.warn("no object of the run has a partner in the image");
        return;
    }
    const double n = double(matched);
    tool.report("mean_abs_shape_factor_difference", absolute / n);
    tool.report("mean_shape_factor_difference", factor / n);
    tool.report("mean_abs_volume_difference", 100.0 * volume / n, "%");
    tool.report("volume_difference", 100.0 * (volume_run / volume_image - 1.0), "%");
    tool.report("mean_distance", distance / n, "mm");
    tool.report("mean_dice", dice / n);
}

void report_phases(const Comparison& comparison, cli::Tool& tool) {
    tool.report("voxels_equal", 100.0 * double(comparison.equal) / double(comparison.voxels), "%");
    nlohmann::ordered_json phases = nlohmann::ordered_json::array();
    bool common = false;
    for (const auto& [label, phase] : comparison.phase) {
        common = common || (label != 0 && phase.run > 0 && phase.image > 0);
        if (label != 0 || phase.image > 0) tool.report(fmt::format("dice_label_{}", label), phase.dice());
        phases.push_back({{"label", label},
                          {"dice", phase.dice()},
                          {"iou", phase.iou()},
                          {"fraction_run", double(phase.run) / double(comparison.voxels)},
                          {"fraction_image", double(phase.image) / double(comparison.voxels)}});
    }
    tool.report_json("phases", phases);
    if (!common) tool.warn("the image and the run have no label in common: name those of the image by --relabel");
    tool.report("closed_porosity_run", 100.0 * comparison.run_porosity, "%");
    tool.report("closed_porosity_image", 100.0 * comparison.image_porosity, "%");
}

void run(const Request& request, cli::Tool& tool) {
    if (!request.pores && request.objects.empty() && request.label_objects.empty())
        throw WrongUsage("say what to compare: --objects or --label-objects of the image, or --pores");
    if (request.pores && request.exclude_boundary)
        throw WrongUsage("--exclude-boundary belongs to objects: a pore at a face of the image is not closed");
    if (request.pores && tool.given("--min-particles"))
        throw WrongUsage("--min-particles belongs to objects; pores are chosen by --min-voxels");
    const ObjectLabels labels = parse_objects(request);
    const RunReader reader(request.run);
    const std::size_t frame = cli::chosen_frame(request.frame, reader.frame_count());
    const int axis = load_axis(reader, request.run);
    Packing packing = reader.packing();
    const BodyChoice choice{request.min_voxels, request.exclude_boundary, axis};
    std::vector<Object> objects_of_run;
    if (!request.pores)
        objects_of_run = choose_objects(packing, {.min_particles = std::size_t(request.min_particles),
                                                  .exclude_boundary = request.exclude_boundary})
                             .used;
    packing.position = reader.frame(frame).position;

    LabelVolume image = read_volume(request.volume, volume_options(request.volume), tool);
    Vec3 shift = Vec3::Zero();
    if (request.align == "centre") {
        std::vector<std::size_t> all(packing.size());
        std::iota(all.begin(), all.end(), 0);
        shift = centre_of_matter(image) - mean_of(packing.position, all);
        for (Vec3& p : packing.position) p += shift;
    }
    require_same_place(image, packing);
    const auto finish = [&](const Comparison& comparison) {
        write_pairs(comparison.matches, request.table, tool);
        tool.report("frame", std::int64_t(frame));
        tool.report("strain", frame_strain(reader, frame));
        for (int c = 0; c < 3; ++c) tool.report(fmt::format("run_moved_{}", "xyz"[c]), shift[c], "mm");
        report_matches(comparison.matches, tool);
        report_phases(comparison, tool);
    };
    const AlphaSurface surface = surface_of_all(packing.position, packing.seed_radius);
    const auto voxelised = [&] {
        return voxelise(packing, surface, {image.size(), image.spacing(), image.origin()}, tool.threads());
    };
    if (request.pores) {
        const VoidParts of_image = void_parts(image, labels.connectivity, choice);
        const VoxelisedRun run = voxelised();
        const VoidParts of_run = void_parts(run.species, labels.connectivity, choice);
        const std::vector<RunBody> bodies = bodies_of_pores(of_run);
        finish(compare(run.species, {of_run.region, of_run.number_of_region, bodies}, image,
                       {of_image.region, of_image.number_of_region, of_image.closed}, labels.connectivity));
    } else {
        const ImageObjects of_image = image_objects(image, labels, choice);
        const std::vector<RunBody> bodies = measure_objects(packing, surface, objects_of_run, axis);
        const VoxelisedRun run = voxelised();
        finish(compare(run.species, {run.object, {}, bodies}, image,
                       {of_image.region, of_image.number_of_region, of_image.used}, labels.connectivity));
    }
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
