#include "core/packing/run_file.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/packing/hdf5_file.hpp"
#include "core/packing/xdmf.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

std::string user_name() {
    const passwd* entry = ::getpwuid(::geteuid());
    return entry != nullptr && entry->pw_name[0] != '\0' ? entry->pw_name : "unknown";
}

void write_provenance(Hdf5Writer& writer, const Provenance& provenance) {
    Hdf5Handle parameters = writer.group(writer.file(), "parameters");
    Hdf5Handle group = writer.group(parameters, "tomodem");
    writer.text_dataset(group, "tool", {provenance.tool}, false);
    writer.text_dataset(group, "version", {provenance.version}, false);
    writer.text_dataset(group, "command_line", {provenance.command_line}, false);
    writer.text_dataset(group, "scene", {provenance.scene}, false);
    if (provenance.strain_before) writer.attribute(group, "strain_before", *provenance.strain_before);
    if (provenance.time_before) writer.attribute(group, "time_before", *provenance.time_before);
    writer.text_dataset(group, "unit_system", {"mm g s"}, false);
    if (!provenance.geometric_error.empty())
        writer.text_dataset(group, "geometric_error", {provenance.geometric_error}, false);
    std::vector<std::string> names, digests;
    for (const auto& [name, digest] : provenance.inputs) {
        names.push_back(name);
        digests.push_back(digest);
    }
    Hdf5Handle inputs = writer.group(group, "inputs");
    writer.text_dataset(inputs, "name", names);
    writer.text_dataset(inputs, "sha256", digests);
}

void write_label_names(Hdf5Writer& writer, const std::map<std::int32_t, std::string>& label_names) {
    if (label_names.empty()) return;
    std::vector<std::int32_t> labels;
    std::vector<std::string> names;
    for (const auto& [label, name] : label_names) {
        labels.push_back(label);
        names.push_back(name);
    }
    const Hdf5Handle group = writer.group(writer.file(), "parameters/tomodem/labels");
    writer.dataset(group, "label", {labels.size()}, labels.data());
    writer.text_dataset(group, "name", names);
}

/// Steps of frames and points that are not written yet.
constexpr std::int64_t not_written = -1;
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

void reserve_series(Hdf5Writer& writer, hid_t group, hsize_t length) {
    writer.reserved<std::int64_t>(group, "step", {length}, not_written);
    const Hdf5Handle times = writer.reserved<double>(group, "time", {length}, no_number);
    writer.attribute(times, "unit", std::string("s"));
}

std::string group_of(const ParticleField& field) {
    return "/particles/all/" + field.name;
}

fs::path sidecar_path(const fs::path& run_file) {
    return fs::path(run_file).replace_extension(".xdmf");
}

}  // namespace

void require_sound_packing(const Packing& packing, const std::string& where) {
    const std::size_t n = packing.size();
    const auto fail = [&](const std::string& what) { throw InvalidInput(where + ": " + what); };
    if (n == 0) fail("there are no particles");
    if (packing.species.size() != n) fail(fmt::format("{} species for {} positions", packing.species.size(), n));
    if (packing.id.size() != n) fail(fmt::format("{} ids for {} positions", packing.id.size(), n));
    if (!packing.object.empty() && packing.object.size() != n)
        fail(fmt::format("{} object numbers for {} positions", packing.object.size(), n));
    if (!packing.radius.empty() && packing.radius.size() != n)
        fail(fmt::format("{} radii for {} positions", packing.radius.size(), n));
    for (std::size_t i = 0; i < packing.radius.size(); ++i)
        if (!(packing.radius[i] > 0.0) || !std::isfinite(packing.radius[i]))
            fail(fmt::format("the radius of particle {} (counted from 1) is {:g}: expected a positive length", i + 1,
                             packing.radius[i]));
    for (const auto& [name, values] : packing.property)
        if (values.size() != n)
            fail(fmt::format("{} values of the property '{}' for {} positions", values.size(), name, n));
    for (std::size_t i = 1; i < n; ++i)
        if (packing.id[i] <= packing.id[i - 1])
            fail(fmt::format("ids are not unique and increasing: {} follows {}", packing.id[i], packing.id[i - 1]));
    if (!(packing.seed_radius > 0.0) || !std::isfinite(packing.seed_radius))
        fail(fmt::format("seed_radius {} is not a positive length", packing.seed_radius));
    if (!packing.box.origin.allFinite() || !packing.box.edges.allFinite() || (packing.box.edges.array() <= 0.0).any())
        fail("the box does not have three positive edges and a finite origin");
}

void create_run_file(const Packing& packing, const RunShape& shape, const Provenance& provenance, const fs::path& where,
                     const fs::path& shown) {
    const auto lock = hdf5_lock();
    require_sound_packing(packing, fmt::format("cannot write '{}'", shown.string()));
    Hdf5Writer writer(where, shown);
    {
        Hdf5Handle h5md = writer.group(writer.file(), "h5md");
        const std::int32_t version[] = {1, 1};
        writer.attribute<std::int32_t>(h5md, "version", version);
        Hdf5Handle author = writer.group(h5md, "author");
        writer.attribute(author, "name", user_name());
        Hdf5Handle creator = writer.group(h5md, "creator");
        writer.attribute(creator, "name", "tomodem " + provenance.tool);
        writer.attribute(creator, "version", provenance.version);
    }
    write_provenance(writer, provenance);
    write_label_names(writer, packing.label_names);

    Hdf5Handle particles = writer.group(writer.file(), "particles");
    Hdf5Handle all = writer.group(particles, "all");
    writer.attribute(all, "seed_radius", packing.seed_radius);
    writer.attribute(all, "seed_radius_unit", std::string("mm"));
    writer.attribute(all, "relaxed", std::int32_t{packing.relaxed});
    if (packing.brick_density > 0) writer.attribute(all, "brick_density", packing.brick_density);

    Hdf5Handle box = writer.group(all, "box");
    writer.attribute(box, "dimension", std::int32_t{3});
    std::vector<std::string> boundary;
    for (const bool periodic : packing.box.periodic) boundary.push_back(periodic ? "periodic" : "none");
    writer.attribute(box, "boundary", boundary);
    const Hdf5Handle edges = writer.dataset(box, "edges", {3}, packing.box.edges.data());
    writer.attribute(edges, "unit", std::string("mm"));
    const Hdf5Handle origin = writer.dataset(box, "origin", {3}, packing.box.origin.data());
    writer.attribute(origin, "unit", std::string("mm"));

    const hsize_t n = packing.size();
    writer.dataset(all, "species", {n}, packing.species.data());
    writer.dataset(all, "id", {n}, packing.id.data());
    if (!packing.object.empty()) writer.dataset(all, "object", {n}, packing.object.data());
    if (!packing.radius.empty()) {
        const Hdf5Handle radius = writer.dataset(all, "radius", {n}, packing.radius.data());
        writer.attribute(radius, "unit", std::string("mm"));
    }
    if (!packing.property.empty()) {
        const Hdf5Handle property = writer.group(all, "property");
        for (const auto& [name, values] : packing.property) writer.dataset(property, name.c_str(), {n}, values.data());
    }

    {
        Hdf5Handle group = writer.group(all, "position");
        const Hdf5Handle value = writer.reserved<double>(group, "value", {shape.frames, n, 3});
        writer.attribute(value, "unit", position_field.unit);
        reserve_series(writer, group, shape.frames);
    }
    for (const ParticleField& field : shape.fields) {
        Hdf5Handle group = writer.group(all, field.name.c_str());
        const Hdf5Handle value =
            writer.reserved<double>(group, "value", {shape.frames, n, static_cast<hsize_t>(field.components)});
        writer.attribute(value, "unit", field.unit);
        for (const auto& [name, number] : field.attributes) writer.attribute(group, name.c_str(), number);
        for (const char* name : {"step", "time"})
            writer.link((group_of(position_field) + "/" + name).c_str(), group, name);
    }

    if (!shape.curves.empty()) {
        const Hdf5Handle group = writer.group(writer.file(), "observables");
        for (const CurveShape& curve : shape.curves) {
            const Hdf5Handle one = writer.group(group, curve.name.c_str());
            writer.attribute(one, "unit", curve.unit);
            const Hdf5Handle value = writer.reserved<double>(one, "value", {curve.points}, no_number);
            writer.attribute(value, "unit", curve.unit);
            reserve_series(writer, one, curve.points);
        }
    }

    const Hdf5Handle views = writer.group(writer.file(), "xdmf");
    std::vector<std::int32_t> vertex(n);
    std::iota(vertex.begin(), vertex.end(), 0);
    writer.dataset(views, "vertex", {n}, vertex.data());
    std::vector<ParticleField> seen{position_field};
    seen.insert(seen.end(), shape.fields.begin(), shape.fields.end());
    for (const ParticleField& field : seen) {
        const hsize_t whole[] = {shape.frames, n, static_cast<hsize_t>(field.components)};
        for (std::size_t f = 0; f < shape.frames; ++f)
            writer.frame_view(views, fmt::format("{}_{}", field.name, f), group_of(field) + "/value", f, whole);
    }
    writer.close();
}

struct RunFile::State {
    Hdf5Filler filler;
    bool together;
    Hdf5Filler::Call all() const { return together ? Hdf5Filler::Call::together : Hdf5Filler::Call::alone; }
};

RunFile::RunFile(const fs::path& where, const fs::path& shown, MPI_Comm processes) {
    const auto lock = hdf5_lock();
    state_.reset(new State{Hdf5Filler(where, shown, processes), processes != MPI_COMM_NULL});
}

RunFile::~RunFile() {
    const auto lock = hdf5_lock();
    state_.reset();
}

void RunFile::write_rows(const ParticleField& field, std::size_t frame, std::size_t first_row,
                         std::span<const double> rows) {
    const auto lock = hdf5_lock();
    const auto components = static_cast<hsize_t>(field.components);
    state_->filler.write(group_of(field) + "/value", {frame, first_row, 0}, {1, rows.size() / components, components},
                         rows.data(), state_->all());
}

void RunFile::mark_frame(std::size_t frame, std::int64_t step, double time) {
    const auto lock = hdf5_lock();
    const std::string group = group_of(position_field);
    state_->filler.write(group + "/time", {frame}, {1}, &time, Hdf5Filler::Call::alone);
    state_->filler.write(group + "/step", {frame}, {1}, &step, Hdf5Filler::Call::alone);
}

void RunFile::write_point(const std::string& curve, std::size_t index, std::int64_t step, double time, double value) {
    const auto lock = hdf5_lock();
    const std::string group = "/observables/" + curve;
    state_->filler.write(group + "/value", {index}, {1}, &value, Hdf5Filler::Call::alone);
    state_->filler.write(group + "/time", {index}, {1}, &time, Hdf5Filler::Call::alone);
    state_->filler.write(group + "/step", {index}, {1}, &step, Hdf5Filler::Call::alone);
}

void RunFile::close() {
    const auto lock = hdf5_lock();
    state_->filler.close();
}

void remove_sidecar(const fs::path& run_file) {
    std::error_code ignored;
    fs::remove(sidecar_path(run_file), ignored);
}

void write_sidecar(std::size_t particles, bool has_objects, const std::vector<double>& times,
                   const std::vector<ParticleField>& fields, const fs::path& run_file) {
    write_text(sidecar_path(run_file), xdmf_text({.h5_name = run_file.filename().string(),
                                                  .particles = particles,
                                                  .times = times,
                                                  .has_objects = has_objects,
                                                  .fields = fields}));
}

}  // namespace tomodem
