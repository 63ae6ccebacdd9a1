// object_shapes: the ellipsoid of every object at every frame of a run, and how the object moved as a whole.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/packing/packing_file.hpp"
#include "tools/metrics/curves/strain_curves.hpp"
#include "tools/metrics/shapes/object_shapes.hpp"
#include "tools/metrics/shapes/object_volumes.hpp"
#include "tools/metrics/shapes/rigid_motion.hpp"

namespace {
using namespace tomodem;
using namespace tomodem::curves;
using namespace tomodem::shapes;

struct Request {
    std::filesystem::path run, table, fields;
    std::string frames = "all";
    std::int64_t min_particles = 20;
    bool exclude_boundary = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{
        "object_shapes",
        "Centre, volume, ellipsoid of inertia, shape factor, displacement and rotation of the objects of a "
        "run, frame by frame."}
        .input("RUN", request.run, "Run or sample (.h5) whose particles carry the number of their object.")
        .output("TABLE", request.table, "Table to write, with one row for each frame and object.", {".csv"})
        .option("--frames", request.frames,
                "Frames to measure: all, first, last, a number from 0, or several as 0,5,last.")
        .option("--min-particles", request.min_particles, cli::Unit::particles, {.low = 4},
                "Leave out objects with fewer particles.")
        .flag("--exclude-boundary", request.exclude_boundary,
              "Leave out objects within one particle diameter of the sample's outer box in the first frame.")
        .output_option("--fields", request.fields,
                       "Also write displacement and rotation of its object for each particle, as a run that ParaView "
                       "opens through the .xdmf beside it.",
                       {".h5"})
        .threads()
        .step(cli::Step::measure)
        .measure({.heading = "Shapes of the objects",
                  .results = {{"shape_factor_last", "shape factor H/D, mean by volume at the end", ""},
                              {"shape_factor_first", "shape factor H/D, at the beginning", ""},
                              {"volume_last", "volume of the objects at the end", "mm³"},
                              {"volume_first", "volume of the objects at the beginning", "mm³"},
                              {"displacement_last", "displacement of the objects at the end, mean", "mm"},
                              {"rotation_last", "rotation of the objects at the end, mean", "°"},
                              {"objects_used", "objects measured", ""},
                              {"objects_too_small", "objects too small", ""},
                              {"objects_at_boundary", "objects left out at the outer faces", ""}},
                  .x = {"strain", "true strain", ""},
                  .curves = {{"shape_factor", "shape factor H/D", ""}}})
        .example("object_shapes run.h5 ellipsoids.csv --exclude-boundary")
        .example("object_shapes run.h5 ellipsoids.csv --fields motion.h5")
        .example("object_shapes run.h5 ellipsoids.csv --frames last --json ellipsoids.json");
}

/// Empty where nothing is enclosed: the particles are far apart, or in one plane.
AlphaSurface surface_or_none(const std::vector<Vec3>& position, double seed_radius) {
    try {
        return surface_of_all(position, seed_radius);
    } catch (const InvalidInput&) {
        return {};
    }
}

/// The objects of one frame, in their order.
struct Measured {
    std::vector<Shape> shapes;
    std::vector<ObjectVolume> volumes;
    std::vector<RigidMotion> motions;  ///< since the first frame of the run
};

std::vector<Measured> measure(const RunReader& reader, const std::vector<Object>& objects,
                              const std::vector<std::size_t>& frames, int axis, cli::Tool& tool) {
    const Packing& packing = reader.packing();
    const double box_share = packing.box.volume() / double(packing.size());
    std::vector<Measured> measured(frames.size());
    const auto progress = tool.progress("frames", double(frames.size()));
    std::mutex mutex;
    double done = 0;
    parallel_for(std::int64_t(frames.size()), tool.threads(), [&](std::int64_t k) {
        const std::vector<Vec3> position = reader.frame(frames[k]).position;
        Measured& of_frame = measured[k];
        of_frame.volumes = object_volumes(surface_or_none(position, packing.seed_radius), objects, box_share);
        for (std::size_t i = 0; i < objects.size(); ++i) {
            const std::vector<std::size_t>& members = objects[i].members;
            of_frame.shapes.push_back(shape_of(mean_of(position, members), of_frame.volumes[i].volume,
                                               second_moments(position, members), axis));
            of_frame.motions.push_back(rigid_motion(packing.position, position, members));
        }
        const std::scoped_lock lock(mutex);
        progress->update(++done);
    });
    for (std::size_t k = 1; k < measured.size(); ++k)
        for (std::size_t i = 0; i < objects.size(); ++i)
            follow(measured[k].shapes[i].ellipsoid, measured[k - 1].shapes[i].ellipsoid);
    return measured;
}

Table::Cell cell(const std::optional<double>& value) {
    if (!value) return std::monostate{};
    return *value;
}

/// Angle of the rotation [degrees].
std::optional<double> angle(const RigidMotion& motion) {
    if (!motion.rotation) return std::nullopt;
    return motion.rotation->norm();
}

std::vector<Table::Cell> cells_of(const RigidMotion& motion) {
    std::vector<Table::Cell> cells{motion.displacement.norm(), motion.displacement.x(), motion.displacement.y(),
                                   motion.displacement.z(), cell(angle(motion))};
    for (int c = 0; c < 3; ++c) cells.push_back(motion.rotation ? Table::Cell((*motion.rotation)[c]) : Table::Cell());
    cells.push_back(cell(motion.residual));
    return cells;
}

/// Displacement and rotation of every object, those too small for a shape included, at its particles.
void write_fields(const RunReader& reader, const std::vector<std::size_t>& frames, const std::filesystem::path& path,
                  Provenance provenance) {
    const Packing& packing = reader.packing();
    std::map<std::int32_t, std::vector<std::size_t>> members_of;
    for (std::size_t i = 0; i < packing.size(); ++i)
        if (packing.object[i] > 0) members_of[packing.object[i]].push_back(i);
    provenance.scene = reader.provenance().scene;
    FieldWriter writer(reader, frames, {{"object_displacement", "mm", 3}, {"object_rotation", "degree", 3}}, path,
                       provenance);
    for (const std::size_t index : frames) {
        const Frame frame = reader.frame(index);
        std::vector<double> displacement(3 * packing.size(), std::numeric_limits<double>::quiet_NaN());
        std::vector<double> rotation = displacement;
        for (const auto& [number, members] : members_of) {
            const RigidMotion motion = rigid_motion(packing.position, frame.position, members);
            for (const std::size_t i : members)
                for (std::size_t c = 0; c < 3; ++c) {
                    displacement[3 * i + c] = motion.displacement[int(c)];
                    if (motion.rotation) rotation[3 * i + c] = (*motion.rotation)[int(c)];
                }
        }
        writer.add_frame(frame, {displacement, rotation});
    }
    writer.commit();
}

std::string followed(const Ellipsoid& ellipsoid) {
    std::string text;
    for (const int axis : ellipsoid.follows) text += "abc"[axis];
    return text;
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.run);
    const int axis = load_axis(reader, request.run);
    const std::vector<std::size_t> frames = cli::chosen_frames(request.frames, reader.frame_count());
    const ChosenObjects chosen = choose_objects(reader.packing(), {.min_particles = std::size_t(request.min_particles),
                                                                   .exclude_boundary = request.exclude_boundary});
    const std::vector<Object>& objects = chosen.used;
    const std::vector<Measured> measured = measure(reader, objects, frames, axis, tool);

    std::vector<std::string> columns{"frame [-]",  "time [s]",    "strain [-]",    "abs_strain [-]",
                                     "object [-]", "species [-]", "particles [-]", "at_boundary [-]"};
    for (const std::string& column : shape_columns()) columns.push_back(column);
    for (const char* column :
         {"follows [-]", "shape_factor_normalised [-]", "volume_share [-]", "displacement [mm]", "displacement_x [mm]",
          "displacement_y [mm]", "displacement_z [mm]", "rotation [degree]", "rotation_x [degree]",
          "rotation_y [degree]", "rotation_z [degree]", "deformation_rms [mm]"})
        columns.emplace_back(column);
    Table table(columns);
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const double strain = frame_strain(reader, frames[k]);
        for (std::size_t i = 0; i < objects.size(); ++i) {
            const Object& object = objects[i];
            const Shape& shape = measured[k].shapes[i];
            const ShareOf share = measured[k].volumes[i].share;
            std::vector<Table::Cell> row{std::int64_t(frames[k]),
                                         reader.frame_time(frames[k]),
                                         strain,
                                         std::abs(strain),
                                         std::int64_t(object.number),
                                         std::int64_t(object.species),
                                         std::int64_t(object.members.size()),
                                         std::int64_t(object.at_boundary)};
            append_cells(shape, row);
            row.emplace_back(followed(shape.ellipsoid));
            row.emplace_back(shape.shape_factor / measured[0].shapes[i].shape_factor);
            row.emplace_back(name_of(share));
            const RigidMotion& motion = measured[k].motions[i];
            for (Table::Cell& value : cells_of(motion)) row.push_back(std::move(value));
            table.add(std::move(row));
            nlohmann::ordered_json& json = rows.emplace_back();
            json = {{"frame", frames[k]},
                    {"strain", strain},
                    {"object", object.number},
                    {"species", object.species},
                    {"particles", object.members.size()},
                    {"at_boundary", object.at_boundary}};
            append_json(shape, json);
            json["follows"] = followed(shape.ellipsoid);
            json["volume_share"] = name_of(share);
            json["displacement"] = {motion.displacement.x(), motion.displacement.y(), motion.displacement.z()};
            if (motion.rotation) {
                json["rotation"] = {motion.rotation->x(), motion.rotation->y(), motion.rotation->z()};
                json["deformation_rms"] = *motion.residual;
            }
        }
    }
    table.write(request.table);
    if (tool.given("--fields")) write_fields(reader, frames, request.fields, tool.provenance());

    const auto mean = [&](const Measured& of_frame) {
        std::vector<double> factors, weights;
        for (std::size_t i = 0; i < objects.size(); ++i) {
            factors.push_back(of_frame.shapes[i].shape_factor);
            weights.push_back(double(objects[i].members.size()));
        }
        return weighted_spread(factors, weights).mean;
    };
    const auto volume = [&](const Measured& of_frame) {
        double sum = 0.0;
        for (const ObjectVolume& of_object : of_frame.volumes) sum += of_object.volume;
        return sum;
    };
    tool.report("frames", std::int64_t(frames.size()));
    tool.report("objects_used", std::int64_t(objects.size()));
    tool.report("objects_too_small", std::int64_t(chosen.too_small));
    if (request.exclude_boundary) tool.report("objects_at_boundary", std::int64_t(chosen.at_boundary));
    tool.report("shape_factor_first", mean(measured.front()));
    tool.report("shape_factor_last", mean(measured.back()));
    tool.report("volume_first", volume(measured.front()), "mm^3");
    tool.report("volume_last", volume(measured.back()), "mm^3");
    if (frames.back() > 0) {
        std::vector<double> displacements, rotations;
        for (const RigidMotion& motion : measured.back().motions) {
            displacements.push_back(motion.displacement.norm());
            if (const std::optional<double> turn = angle(motion)) rotations.push_back(*turn);
        }
        tool.report("displacement_last", plain_spread(displacements).mean, "mm");
        if (!rotations.empty()) tool.report("rotation_last", plain_spread(rotations).mean, "degree");
    }
    tool.report_json("shapes", rows);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
