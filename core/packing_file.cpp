#include "core/packing_file.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "core/hdf5_file.hpp"
#include "core/output_file.hpp"
#include "core/xdmf.hpp"

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
    writer.text_dataset(group, "unit_system", {"mm g s"}, false);
    std::vector<std::string> names, digests;
    for (const auto& [name, digest] : provenance.inputs) {
        names.push_back(name);
        digests.push_back(digest);
    }
    Hdf5Handle inputs = writer.group(group, "inputs");
    writer.text_dataset(inputs, "name", names);
    writer.text_dataset(inputs, "sha256", digests);
}

void require_finite(std::span<const Vec3> positions, const std::string& where) {
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!positions[i].allFinite())
            throw InvalidInput(
                fmt::format("{}: the position of particle {} (counted from 1) is not a finite number", where, i + 1));
}

/// The arrays of a packing fit together, whoever made it.
void require_sound(const Packing& packing, const std::string& where) {
    const std::size_t n = packing.size();
    const auto fail = [&](const std::string& what) { throw InvalidInput(where + ": " + what); };
    if (n == 0) fail("there are no particles");
    if (packing.species.size() != n) fail(fmt::format("{} species for {} positions", packing.species.size(), n));
    if (packing.id.size() != n) fail(fmt::format("{} ids for {} positions", packing.id.size(), n));
    if (!packing.object.empty() && packing.object.size() != n)
        fail(fmt::format("{} object numbers for {} positions", packing.object.size(), n));
    for (std::size_t i = 1; i < n; ++i)
        if (packing.id[i] <= packing.id[i - 1])
            fail(fmt::format("ids are not unique and increasing: {} follows {}", packing.id[i], packing.id[i - 1]));
    if (!(packing.seed_radius > 0.0) || !std::isfinite(packing.seed_radius))
        fail(fmt::format("seed_radius {} is not a positive length", packing.seed_radius));
    if (!packing.box.origin.allFinite() || !packing.box.edges.allFinite() || (packing.box.edges.array() <= 0.0).any())
        fail("the box does not have three positive edges and a finite origin");
}

constexpr const char* positions_path = "/particles/all/position/value";

Box read_box(const Hdf5Reader& reader) {
    Box box;
    if (reader.is_group("/particles/all/box/edges"))
        reader.fail("its box changes with time, which tomodem does not use");
    box.edges = reader.vector("/particles/all/box/edges");
    if (reader.exists("/particles/all/box/origin")) box.origin = reader.vector("/particles/all/box/origin");
    const auto boundary = reader.text_attribute("/particles/all/box", "boundary");
    if (boundary.size() != 3) reader.fail("/particles/all/box has no attribute boundary of 3 words");
    for (int axis = 0; axis < 3; ++axis) {
        if (boundary[axis] != "none" && boundary[axis] != "periodic")
            reader.fail(
                fmt::format("boundary '{}' of /particles/all/box is neither none nor periodic", boundary[axis]));
        box.periodic[axis] = boundary[axis] == "periodic";
    }
    return box;
}

Provenance read_provenance(const Hdf5Reader& reader) {
    const std::string group = "/parameters/tomodem/";
    Provenance provenance{reader.one_text(group + "tool"),
                          reader.one_text(group + "version"),
                          reader.one_text(group + "command_line"),
                          reader.one_text(group + "scene"),
                          {}};
    const auto names = reader.text_dataset(group + "inputs/name");
    const auto digests = reader.text_dataset(group + "inputs/sha256");
    for (std::size_t i = 0; i < std::min(names.size(), digests.size()); ++i) provenance.inputs[names[i]] = digests[i];
    return provenance;
}

std::map<std::string, Observable> read_observables(const Hdf5Reader& reader) {
    std::map<std::string, Observable> curves;
    if (!reader.is_group("/observables")) return curves;
    for (const std::string& name : reader.members("/observables")) {
        const std::string group = "/observables/" + name;
        if (!reader.exists(group + "/value")) continue;  // another program's, not a curve
        Observable curve;
        curve.value = reader.array<double>(group + "/value");
        curve.step = reader.array<std::int64_t>(group + "/step");
        curve.time = reader.array<double>(group + "/time");
        const auto unit = reader.text_attribute(group, "unit");
        if (!unit.empty()) curve.unit = unit.front();
        if (curve.step.size() != curve.value.size() || curve.time.size() != curve.value.size())
            reader.fail(fmt::format("{} has {} values, {} steps and {} times", group, curve.value.size(),
                                    curve.step.size(), curve.time.size()));
        curves.emplace(name, std::move(curve));
    }
    return curves;
}

}  // namespace

struct RunReader::State {
    explicit State(const fs::path& path) : reader(path) {}
    Hdf5Reader reader;
    Packing packing;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::map<std::string, Observable> observables;
    Provenance provenance;
};

RunReader::RunReader(const fs::path& path) {
    const auto lock = hdf5_lock();
    state_ = std::make_unique<State>(path);
    const Hdf5Reader& reader = state_->reader;
    if (!reader.exists("/h5md") || !reader.exists("/particles/all"))
        reader.fail("it has no /h5md and /particles/all: not a packing or run of tomodem (H5MD)");

    Packing& packing = state_->packing;
    packing.box = read_box(reader);
    packing.species = reader.array<std::int32_t>("/particles/all/species");
    packing.id = reader.array<std::int64_t>("/particles/all/id");
    if (reader.exists("/particles/all/object")) packing.object = reader.array<std::int32_t>("/particles/all/object");
    const auto seed_radius = reader.number_attribute<double>("/particles/all", "seed_radius");
    if (!seed_radius) reader.fail("/particles/all has no attribute seed_radius");
    packing.seed_radius = *seed_radius;
    packing.relaxed = reader.number_attribute<std::int32_t>("/particles/all", "relaxed").value_or(0) != 0;

    const Hdf5Shape shape = reader.shape(reader.dataset(positions_path), positions_path);
    if (shape.size() != 3 || shape[2] != 3)
        reader.fail(fmt::format("{} is not frames x particles x 3", positions_path));
    if (shape[0] == 0) reader.fail(fmt::format("{} has no frame", positions_path));
    state_->step = reader.array<std::int64_t>("/particles/all/position/step");
    state_->time = reader.array<double>("/particles/all/position/time");
    if (state_->step.size() != shape[0] || state_->time.size() != shape[0])
        reader.fail(fmt::format("{} has {} frames, but there are {} steps and {} times", positions_path, shape[0],
                                state_->step.size(), state_->time.size()));
    if (packing.species.size() != shape[1])
        reader.fail(fmt::format("/particles/all/species has {} values but {} has {} rows", packing.species.size(),
                                positions_path, shape[1]));
    packing.position = frame(0).position;
    require_sound(packing, reader.failure());
    state_->observables = read_observables(reader);
    state_->provenance = read_provenance(reader);
}

RunReader::~RunReader() {
    const auto lock = hdf5_lock();
    state_.reset();
}

const Packing& RunReader::packing() const {
    return state_->packing;
}
std::size_t RunReader::frame_count() const {
    return state_->step.size();
}
std::int64_t RunReader::frame_step(std::size_t index) const {
    return state_->step.at(index);
}
double RunReader::frame_time(std::size_t index) const {
    return state_->time.at(index);
}
const std::map<std::string, Observable>& RunReader::observables() const {
    return state_->observables;
}
const Provenance& RunReader::provenance() const {
    return state_->provenance;
}

Frame RunReader::frame(std::size_t index) const {
    if (index >= frame_count())
        state_->reader.fail(fmt::format("there is no frame {}, it has frames 0 to {}", index, frame_count() - 1));
    const auto lock = hdf5_lock();
    Frame frame{frame_step(index), frame_time(index), state_->reader.frame(positions_path, index)};
    require_finite(frame.position, fmt::format("{}, frame {}", state_->reader.failure(), index));
    return frame;
}

const Observable& RunReader::observable(const std::string& name) const {
    const auto found = state_->observables.find(name);
    if (found != state_->observables.end()) return found->second;
    std::string known;
    for (const auto& [other, curve] : state_->observables) known += (known.empty() ? "" : ", ") + other;
    state_->reader.fail(known.empty()
                            ? fmt::format("it has no curve '{}', nor any other: give a run, not a sample", name)
                            : fmt::format("it has no curve '{}', only {}", name, known));
}

Packing read_packing(const fs::path& path, std::int64_t frame) {
    const RunReader reader(path);
    const auto count = static_cast<std::int64_t>(reader.frame_count());
    if (frame < -1 || frame >= count)
        throw InvalidInput(fmt::format("cannot read '{}': there is no frame {}, it has frames 0 to {}", path.string(),
                                       frame, count - 1));
    Packing packing = reader.packing();
    const std::int64_t index = frame == -1 ? count - 1 : frame;
    if (index > 0) packing.position = reader.frame(static_cast<std::size_t>(index)).position;
    return packing;
}

Packing read_sample(const fs::path& path) {
    const RunReader reader(path);
    if (reader.frame_count() > 1)
        throw InvalidInput(fmt::format("cannot start from '{}': it is a run of {} frames; give a sample", path.string(),
                                       reader.frame_count()));
    return reader.packing();
}

double value_at(const Observable& curve, double time) {
    if (curve.value.empty()) throw InvalidInput("a curve without points has no value");
    const auto after = std::upper_bound(curve.time.begin(), curve.time.end(), time);
    if (after == curve.time.begin()) return curve.value.front();
    if (after == curve.time.end()) return curve.value.back();
    const auto i = static_cast<std::size_t>(after - curve.time.begin());
    const double share = (time - curve.time[i - 1]) / (curve.time[i] - curve.time[i - 1]);
    return std::lerp(curve.value[i - 1], curve.value[i], share);
}

struct RunWriter::State {
    State(const Packing& packing, const fs::path& path)
        : final_path(path),
          sidecar_path(fs::path(path).replace_extension(".xdmf")),
          output(path),
          writer(output.path(), path),
          particles(packing.size()),
          has_objects(!packing.object.empty()) {}

    fs::path final_path, sidecar_path;
    OutputFile output;
    Hdf5Writer writer;
    std::size_t particles;
    bool has_objects;
    std::optional<Hdf5Handle> positions;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::map<std::string, Observable> observables;
};

RunWriter::RunWriter(const Packing& packing, const fs::path& path, const Provenance& provenance) {
    const auto lock = hdf5_lock();
    const std::string failure = fmt::format("cannot write '{}'", path.string());
    if (path.extension() == ".xdmf")
        throw InvalidInput(failure + ": name the HDF5 file (.h5), the .xdmf comes beside it");
    require_sound(packing, failure);

    state_ = std::make_unique<State>(packing, path);
    Hdf5Writer& writer = state_->writer;
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

    Hdf5Handle particles = writer.group(writer.file(), "particles");
    Hdf5Handle all = writer.group(particles, "all");
    writer.attribute(all, "seed_radius", packing.seed_radius);
    writer.attribute(all, "seed_radius_unit", std::string("mm"));
    writer.attribute(all, "relaxed", std::int32_t{packing.relaxed});

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
    if (state_->has_objects) writer.dataset(all, "object", {n}, packing.object.data());

    Hdf5Handle position = writer.group(all, "position");
    state_->positions.emplace(writer.growing_frames(position, "value", n));
    writer.attribute(*state_->positions, "unit", std::string("mm"));
}

RunWriter::~RunWriter() {
    const auto lock = hdf5_lock();
    state_.reset();
}

void RunWriter::add_frame(const Frame& frame) {
    const auto lock = hdf5_lock();
    const std::string where =
        fmt::format("{}, frame {} (step {})", state_->writer.failure(), state_->step.size(), frame.step);
    if (frame.position.size() != state_->particles)
        throw InvalidInput(
            fmt::format("{}: {} positions for {} particles", where, frame.position.size(), state_->particles));
    require_finite(frame.position, where);
    state_->writer.append_frame(*state_->positions, state_->step.size(), frame.position);
    state_->step.push_back(frame.step);
    state_->time.push_back(frame.time);
}

void RunWriter::add_observable(const std::string& name, const std::string& unit, std::int64_t step, double time,
                               double value) {
    Observable& curve = state_->observables.try_emplace(name, Observable{unit, {}, {}, {}}).first->second;
    curve.step.push_back(step);
    curve.time.push_back(time);
    curve.value.push_back(value);
}

void RunWriter::commit() {
    const auto lock = hdf5_lock();
    Hdf5Writer& writer = state_->writer;
    if (state_->step.empty()) throw InvalidInput(writer.failure() + ": the run has no frame");

    const auto series = [&](hid_t group, const std::vector<std::int64_t>& step, const std::vector<double>& time) {
        writer.dataset(group, "step", {step.size()}, step.data());
        const Hdf5Handle times = writer.dataset(group, "time", {time.size()}, time.data());
        writer.attribute(times, "unit", std::string("s"));
    };
    {
        const Hdf5Handle position = writer.open_group("/particles/all/position");
        series(position, state_->step, state_->time);
    }
    if (!state_->observables.empty()) {
        const Hdf5Handle group = writer.group(writer.file(), "observables");
        for (const auto& [name, curve] : state_->observables) {
            const Hdf5Handle one = writer.group(group, name.c_str());
            writer.attribute(one, "unit", curve.unit);
            const Hdf5Handle value = writer.dataset(one, "value", {curve.value.size()}, curve.value.data());
            writer.attribute(value, "unit", curve.unit);
            series(one, curve.step, curve.time);
        }
    }
    state_->positions.reset();
    {
        const Hdf5Handle views = writer.group(writer.file(), "xdmf");
        std::vector<std::int32_t> vertex(state_->particles);
        std::iota(vertex.begin(), vertex.end(), 0);
        writer.dataset(views, "vertex", {vertex.size()}, vertex.data());
        for (std::size_t f = 0; f < state_->step.size(); ++f)
            writer.frame_view(views, fmt::format("position_{}", f), positions_path, f, state_->step.size(),
                              state_->particles);
    }
    writer.close();
    state_->output.flush();

    // A sidecar never stands beside a file it does not describe: the old one goes first, the new one comes last.
    std::error_code ignored;
    fs::remove(state_->sidecar_path, ignored);
    state_->output.commit();
    write_text(state_->sidecar_path, xdmf_text({.h5_name = state_->final_path.filename().string(),
                                                .particles = state_->particles,
                                                .times = state_->time,
                                                .has_objects = state_->has_objects}));
}

void write_packing(const Packing& packing, const fs::path& path, const Provenance& provenance) {
    RunWriter writer(packing, path, provenance);
    writer.add_frame({0, 0.0, packing.position});
    writer.commit();
}

}  // namespace tomodem
