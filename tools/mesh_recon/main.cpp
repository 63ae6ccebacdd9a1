// mesh_recon: wrap the particle centres of a sample, a phase, objects or pores in closed triangle meshes.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/table.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/vtp_file.hpp"
#include "core/packing/packing_file.hpp"
#include "core/surface/reconstruction.hpp"

namespace {
using namespace tomodem;
namespace fs = std::filesystem;

struct Request {
    fs::path packing, mesh, table;
    double probe_radius = 0.0, lid_radius = 0.0;  // mm; 0: one particle diameter, no lid
    std::int64_t species = 0, object = 0;
    std::string frame = "last", frames = "last";
    bool pores = false, each_object = false, correct_envelope = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"mesh_recon",
                      "Wrap the particles of a sample, a phase, objects, or its pores in closed triangle meshes."}
        .input("RUN", request.packing, "Run or sample (.h5) to wrap.")
        .output(
            "MESH", request.mesh,
            "Surface to write. With --frames all, each frame has a file, NAME_0000.EXT and so on; for .vtp and .pvd "
            "these are .vtp files, and NAME.pvd lists them for ParaView. A name in .pvd needs --frames all.",
            {".stl", ".ply", ".vtp", ".obj", ".pvd"})
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "Fill the gaps between centres that a ball of this radius cannot enter; the default is one particle "
                "diameter.")
        .option("--frame", request.frame, "Take this frame of the run: first, last or a number from 0.")
        .choice("--frames", request.frames, {"first", "last", "all"}, "Take these frames of the run.")
        .option("--species", request.species, cli::Unit::none, cli::positive, "Take only the phase of this label.")
        .option("--object", request.object, cli::Unit::none, cli::positive, "Take only the object of this number.")
        .flag("--each-object", request.each_object, "Wrap every object by itself; all go into one mesh.")
        .flag("--pores", request.pores, "Wrap the closed pores instead of the solid.")
        .option("--lid-radius", request.lid_radius, cli::Unit::length, cli::positive,
                "With --pores, also wrap pores that are open to the outside; a lid, the surface on which a ball of "
                "this radius rolls over the sample, closes them. Without it, only closed pores are wrapped.")
        .flag("--correct-envelope", request.correct_envelope,
              "Move each surface to where the material ends; without it, the surface runs through the centres of the "
              "outermost particles.")
        .output_option("--bodies", request.table, "Also write the measures of each body or pore.", {".csv"})
        .step(cli::Step::surface)
        .exclusive({"--species", "--object", "--each-object"})
        .exclusive({"--pores", "--each-object"})
        .exclusive({"--frame", "--frames"})
        .threads()
        .example("mesh_recon run.h5 inclusions.stl --species 2")
        .example("mesh_recon run.h5 pores.pvd --pores --frames all --bodies pores.csv");
}

Table::Cell number_or_empty(double value) {
    if (std::isnan(value)) return std::monostate{};
    return value;
}

Table table_of(const RunReader& run, const std::vector<std::size_t>& frames, const std::vector<Reconstruction>& results,
               bool pores) {
    Table table({"frame [-]", "time [s]", "kind [-]", "body [-]", "object [-]", "particles [-]", "volume [mm^3]",
                 "volume_corrected [mm^3]", "area [mm^2]", "centre_x [mm]", "centre_y [mm]", "centre_z [mm]",
                 "shells [-]", "genus [-]", "euler_characteristic [-]"});
    for (std::size_t k = 0; k < frames.size(); ++k)
        for (std::size_t i = 0; i < results[k].rows.size(); ++i) {
            const auto& [object, body] = results[k].rows[i];
            table.add({std::int64_t(frames[k]), run.frame_time(frames[k]), pores ? "pore" : "solid",
                       std::int64_t(i + 1), std::int64_t(object), body.particles, body.volume,
                       number_or_empty(body.corrected_volume), body.area, body.centre.x(), body.centre.y(),
                       body.centre.z(), body.shells, body.genus, body.euler_characteristic()});
        }
    return table;
}

nlohmann::ordered_json json_of(const std::vector<std::size_t>& frames, const std::vector<Reconstruction>& results,
                               bool pores) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < frames.size(); ++k)
        for (std::size_t i = 0; i < results[k].rows.size(); ++i) {
            const auto& [object, body] = results[k].rows[i];
            nlohmann::ordered_json row{{"frame", frames[k]},
                                       {"kind", pores ? "pore" : "solid"},
                                       {"body", i + 1},
                                       {"object", object},
                                       {"particles", body.particles},
                                       {"volume", body.volume},
                                       {"volume_corrected", body.corrected_volume},
                                       {"area", body.area},
                                       {"centre", {body.centre.x(), body.centre.y(), body.centre.z()}},
                                       {"shells", body.shells},
                                       {"genus", body.genus},
                                       {"euler_characteristic", body.euler_characteristic()}};
            rows.push_back(std::move(row));  // a volume that is not a number becomes null
        }
    return rows;
}

/// Files that go again unless all of them were written.
struct Series {
    ~Series() {
        std::error_code ignored;
        for (const fs::path& path : written) fs::remove(path, ignored);
    }
    std::vector<fs::path> written;
    std::mutex mutex;
};

void write(const Reconstruction& result, const fs::path& path) {
    const TriangleNumber body{"body", result.body_of_triangle}, object{"object", result.object_of_triangle};
    write_mesh(result.mesh, path, {body, object});
}

void run(const Request& request, cli::Tool& tool) {
    const RunReader reader(request.packing);
    const bool all = request.frames == "all";
    const std::vector<std::size_t> frames = tool.given("--frame")
                                                ? std::vector{cli::chosen_frame(request.frame, reader.frame_count())}
                                                : cli::chosen_frames(request.frames, reader.frame_count());
    const bool collection = request.mesh.extension() == ".pvd";
    if (collection && !all)
        throw InvalidInput(
            fmt::format("'{}' is a series: give --frames all, or a name that ends in .vtp", request.mesh.string()));

    const Packing& packing = reader.packing();
    ReconstructionOptions options;
    if (tool.given("--species")) options.selection.species = request.species;
    if (tool.given("--object")) options.selection.object = request.object;
    options.bodies = request.pores ? Bodies::pores : request.each_object ? Bodies::objects : Bodies::parts;
    options.envelope = request.correct_envelope ? Envelope::corrected : Envelope::centres;
    if (tool.given("--lid-radius")) {
        if (!request.pores) throw WrongUsage("--lid-radius goes with --pores only");
        options.lid_radius = request.lid_radius;
    }
    options.probe_radius =
        tool.given("--probe-radius") ? request.probe_radius : default_probe_radius(packing.seed_radius);

    const auto progress = tool.progress("alpha shape", double(frames.size()));
    if (frames.size() == 1) options.progress = [&](double done) { progress->update(done); };
    std::vector<Reconstruction> results(frames.size());
    Series series;
    std::vector<std::pair<double, fs::path>> at_time(frames.size());
    std::size_t done = 0;
    parallel_for(std::int64_t(frames.size()), tool.threads(), [&](std::int64_t k) {
        Packing moved = packing;
        moved.position = reader.frame(frames[k]).position;
        Reconstruction& result = results[k];
        try {
            result = reconstruct(moved, options);
        } catch (const InvalidInput& error) {
            if (!all) throw;
            throw InvalidInput(fmt::format("frame {}: {}", frames[k], error.what()));
        }
        if (!all) return;
        const std::string extension = collection ? ".vtp" : request.mesh.extension().string();
        const fs::path path =
            request.mesh.parent_path() / fmt::format("{}_{:04}{}", request.mesh.stem().string(), frames[k], extension);
        write(result, path);
        result.mesh = {};
        at_time[k] = {reader.frame_time(frames[k]), path};
        const std::scoped_lock lock(series.mutex);
        series.written.push_back(path);
        progress->update(double(++done));
    });
    if (!all)
        write(results.front(), request.mesh);
    else if (collection || request.mesh.extension() == ".vtp")
        write_pvd(fs::path(request.mesh).replace_extension(".pvd"), at_time);
    if (tool.given("--bodies")) table_of(reader, frames, results, request.pores).write(request.table);
    series.written.clear();

    const Reconstruction& shown = results.back();
    if (options.probe_radius > 10 * default_probe_radius(packing.seed_radius))
        tool.warn(
            fmt::format("a probe of {:g} mm is more than ten particle diameters: the mesh is nearly the convex hull",
                        options.probe_radius));
    if (request.pores && shown.rows.empty()) tool.warn("there is no pore: the mesh is empty");
    if (shown.objects_left_out > 0)
        tool.warn(
            fmt::format("{} objects enclose no volume at this probe radius and are left out", shown.objects_left_out));
    if (all) tool.report("frames", std::int64_t(frames.size()));
    tool.report("particles", shown.particles);
    tool.report("probe_radius", options.probe_radius, "mm");
    tool.report("volume", shown.volume(), "mm^3");
    if (!std::isnan(shown.corrected_volume())) tool.report("volume_corrected", shown.corrected_volume(), "mm^3");
    tool.report("area", shown.area(), "mm^2");
    tool.report("components", std::int64_t(shown.rows.size()));
    tool.report("largest_component_volume", shown.largest(), "mm^3");
    tool.report("shells", shown.shells());
    tool.report("genus", shown.genus());
    tool.report("triangles", std::int64_t(shown.body_of_triangle.size()));
    tool.report_json("bodies", json_of(frames, results, request.pores));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
