#include "core/mesh/export_frames.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "core/base/binary_output.hpp"
#include "core/base/error.hpp"
#include "core/mesh/vtp_file.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

/// Rows of a field with the components of a tensor in VTK's order: run files have xz before yz.
std::vector<double> in_vtk_order(std::vector<double> values, int components) {
    if (components == 6)
        for (std::size_t i = 0; i < values.size(); i += 6) std::swap(values[i + 4], values[i + 5]);
    return values;
}

/// Names of the columns of a field in a dump; OVITO takes vx vy vz for the velocity.
std::vector<std::string> column_names(const ParticleField& field) {
    if (field.components == 1) return {field.name};
    if (field.name == "velocity" && field.components == 3) return {"vx", "vy", "vz"};
    std::vector<std::string> endings{"x", "y", "z"};
    if (field.components == 6) endings = {"xx", "yy", "zz", "xy", "xz", "yz"};
    std::vector<std::string> names;
    for (int k = 0; k < field.components; ++k)
        names.push_back(
            field.name + "_" +
            (field.components == 3 || field.components == 6 ? endings[std::size_t(k)] : std::to_string(k + 1)));
    return names;
}

void write_vtp_frame(const RunReader& run, std::size_t index, const fs::path& path) {
    const Packing& packing = run.packing();
    const Frame frame = run.frame(index);
    const std::vector<double> radius =
        packing.radius.empty() ? std::vector<double>(packing.size(), packing.seed_radius) : packing.radius;
    std::vector<PointArray> arrays{{"species", std::span<const std::int32_t>(packing.species)},
                                   {"id", std::span<const std::int64_t>(packing.id)},
                                   {"radius", std::span<const double>(radius)}};
    if (!packing.object.empty()) arrays.push_back({"object", std::span<const std::int32_t>(packing.object)});
    for (const auto& [name, values] : packing.property) arrays.push_back({name, std::span<const double>(values)});
    std::vector<std::vector<double>> values;
    values.reserve(run.fields().size());
    for (const ParticleField& field : run.fields()) {
        values.push_back(in_vtk_order(run.field_values(field.name, index), field.components));
        arrays.push_back({field.name, std::span<const double>(values.back()), field.components});
    }
    write_vtp(path, frame.position, {}, arrays);
}

}  // namespace

void export_dump(const RunReader& run, const std::vector<std::size_t>& frames, const fs::path& output,
                 const FrameDone& done) {
    const Packing& packing = run.packing();
    const Box& box = packing.box;
    BinaryOutput out(output);
    fmt::memory_buffer text;
    std::string columns = "id type x y z radius object";
    for (const ParticleField& field : run.fields())
        for (const std::string& name : column_names(field)) columns += " " + name;
    for (std::size_t count = 0; count < frames.size(); ++count) {
        const Frame frame = run.frame(frames[count]);
        text.clear();
        auto end = std::back_inserter(text);
        fmt::format_to(end, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS", frame.step,
                       packing.size());
        for (const bool periodic : box.periodic) fmt::format_to(end, " {}", periodic ? "pp" : "ff");
        for (int axis = 0; axis < 3; ++axis)
            fmt::format_to(end, "\n{} {}", box.origin[axis], box.origin[axis] + box.edges[axis]);
        fmt::format_to(end, "\nITEM: ATOMS {}\n", columns);
        std::vector<std::vector<double>> fields;
        for (const ParticleField& field : run.fields()) fields.push_back(run.field_values(field.name, frames[count]));
        for (std::size_t i = 0; i < packing.size(); ++i) {
            const Vec3& p = frame.position[i];
            fmt::format_to(end, "{} {} {} {} {} {} {}", packing.id[i], packing.species[i], p.x(), p.y(), p.z(),
                           packing.radius_of(i), packing.object.empty() ? 0 : packing.object[i]);
            for (std::size_t f = 0; f < fields.size(); ++f) {
                const auto components = std::size_t(run.fields()[f].components);
                for (std::size_t k = 0; k < components; ++k) fmt::format_to(end, " {}", fields[f][i * components + k]);
            }
            text.push_back('\n');
        }
        out.text({text.data(), text.size()});
        if (done) done(count + 1);
    }
    out.commit();
}

std::vector<fs::path> export_vtp(const RunReader& run, const std::vector<std::size_t>& frames, const fs::path& output,
                                 const FrameDone& done) {
    if (frames.size() == 1 && output.extension() != ".pvd") {
        write_vtp_frame(run, frames.front(), output);
        if (done) done(1);
        return {output};
    }
    struct Cleanup {  // a series is complete or not there
        ~Cleanup() {
            std::error_code ignored;
            for (const fs::path& path : written) fs::remove(path, ignored);
        }
        std::vector<fs::path> written;
    } series;
    std::vector<fs::path>& written = series.written;
    std::vector<std::pair<double, fs::path>> at_time;
    for (const std::size_t frame : frames) {
        const fs::path path = output.parent_path() / fmt::format("{}_{:04}.vtp", output.stem().string(), frame);
        write_vtp_frame(run, frame, path);
        at_time.emplace_back(run.frame_time(frame), path);
        written.push_back(path);
        if (done) done(written.size());
    }
    const fs::path index_path = fs::path(output).replace_extension(".pvd");
    write_pvd(index_path, at_time);
    written.push_back(index_path);
    return std::exchange(written, {});
}

}  // namespace tomodem
