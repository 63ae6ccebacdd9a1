#include "core/packing/packing_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/packing/hdf5_file.hpp"
#include "core/packing/run_file.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

void require_finite(std::span<const Vec3> positions, const std::string& where) {
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!positions[i].allFinite())
            throw InvalidInput(
                fmt::format("{}: the position of particle {} (counted from 1) is not a finite number", where, i + 1));
}

std::vector<Vec3> vectors(const std::vector<double>& numbers) {
    std::vector<Vec3> rows(numbers.size() / 3);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    return rows;
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
    provenance.strain_before = reader.number_attribute<double>("/parameters/tomodem", "strain_before");
    provenance.time_before = reader.number_attribute<double>("/parameters/tomodem", "time_before");
    if (reader.exists(group + "geometric_error"))
        provenance.geometric_error = reader.one_text(group + "geometric_error");
    const auto names = reader.text_dataset(group + "inputs/name");
    const auto digests = reader.text_dataset(group + "inputs/sha256");
    for (std::size_t i = 0; i < std::min(names.size(), digests.size()); ++i) provenance.inputs[names[i]] = digests[i];
    return provenance;
}

std::map<std::int32_t, std::string> read_label_names(const Hdf5Reader& reader) {
    std::map<std::int32_t, std::string> found;
    const std::string group = "/parameters/tomodem/labels";
    if (!reader.is_group(group)) return found;
    const auto labels = reader.array<std::int32_t>(group + "/label");
    const auto names = reader.text_dataset(group + "/name");
    if (labels.size() != names.size())
        reader.fail(fmt::format("{} has {} labels and {} names", group, labels.size(), names.size()));
    for (std::size_t k = 0; k < labels.size(); ++k) found[labels[k]] = names[k];
    return found;
}

/// Places that an unfinished run has filled: steps are negative from there on.
std::size_t written(const std::vector<std::int64_t>& steps) {
    return static_cast<std::size_t>(
        std::find_if(steps.begin(), steps.end(), [](std::int64_t step) { return step < 0; }) - steps.begin());
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
        const std::size_t points = written(curve.step);
        curve.value.resize(points);
        curve.step.resize(points);
        curve.time.resize(points);
        curves.emplace(name, std::move(curve));
    }
    return curves;
}

std::vector<ParticleField> read_fields(const Hdf5Reader& reader, const Hdf5Shape& positions) {
    std::vector<ParticleField> fields;
    for (const std::string& name : reader.members("/particles/all")) {
        const std::string group = "/particles/all/" + name, value = group + "/value";
        if (name == "position" || !reader.is_group(group) || !reader.exists(value)) continue;
        const Hdf5Shape shape = reader.shape(reader.dataset(value), value);
        if (shape.size() != 3 || shape[0] != positions[0] || shape[1] != positions[1])
            continue;  // another program's, not a field
        ParticleField field{name, "", static_cast<int>(shape[2]), reader.number_attributes(group)};
        const auto unit = reader.text_attribute(value, "unit");
        if (!unit.empty()) field.unit = unit.front();
        fields.push_back(std::move(field));
    }
    return fields;
}

}  // namespace

struct RunReader::State {
    explicit State(const fs::path& path) : reader(path) {}
    Hdf5Reader reader;
    Packing packing;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::map<std::string, Observable> observables;
    std::vector<ParticleField> fields;
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
    if (reader.exists("/particles/all/radius")) packing.radius = reader.array<double>("/particles/all/radius");
    if (constexpr const char* group = "/particles/all/property"; reader.is_group(group))
        for (const std::string& name : reader.members(group))
            packing.property[name] = reader.array<double>(std::string(group) + "/" + name);
    packing.label_names = read_label_names(reader);
    const auto seed_radius = reader.number_attribute<double>("/particles/all", "seed_radius");
    if (!seed_radius) reader.fail("/particles/all has no attribute seed_radius");
    packing.seed_radius = *seed_radius;
    packing.relaxed = reader.number_attribute<std::int32_t>("/particles/all", "relaxed").value_or(0) != 0;
    packing.brick_density = reader.number_attribute<double>("/particles/all", "brick_density").value_or(0);

    const Hdf5Shape shape = reader.shape(reader.dataset(positions_path), positions_path);
    if (shape.size() != 3 || shape[2] != 3)
        reader.fail(fmt::format("{} is not frames x particles x 3", positions_path));
    if (shape[0] == 0) reader.fail(fmt::format("{} has no frame", positions_path));
    state_->step = reader.array<std::int64_t>("/particles/all/position/step");
    state_->time = reader.array<double>("/particles/all/position/time");
    if (state_->step.size() != shape[0] || state_->time.size() != shape[0])
        reader.fail(fmt::format("{} has {} frames, but there are {} steps and {} times", positions_path, shape[0],
                                state_->step.size(), state_->time.size()));
    state_->step.resize(written(state_->step));
    state_->time.resize(state_->step.size());
    if (state_->step.empty()) reader.fail("its first frame is not written yet");
    if (packing.species.size() != shape[1])
        reader.fail(fmt::format("/particles/all/species has {} values but {} has {} rows", packing.species.size(),
                                positions_path, shape[1]));
    packing.position = frame(0).position;
    require_sound_packing(packing, reader.failure());
    state_->fields = read_fields(reader, shape);
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

void RunReader::require_frame(std::size_t index) const {
    if (index >= frame_count())
        state_->reader.fail(fmt::format("there is no frame {}, it has frames 0 to {}", index, frame_count() - 1));
}

Frame RunReader::frame(std::size_t index) const {
    require_frame(index);
    const auto lock = hdf5_lock();
    Frame frame{frame_step(index), frame_time(index), vectors(state_->reader.frame(positions_path, index))};
    require_finite(frame.position, fmt::format("{}, frame {}", state_->reader.failure(), index));
    return frame;
}

const std::vector<ParticleField>& RunReader::fields() const {
    return state_->fields;
}

const ParticleField& RunReader::field(const std::string& name) const {
    std::vector<std::string> known;
    for (const ParticleField& field : state_->fields) {
        if (field.name == name) return field;
        known.push_back(field.name);
    }
    state_->reader.fail(fmt::format(
        "its particles have no '{}', {}", name,
        known.empty() ? "nor anything else but their positions" : fmt::format("only {}", fmt::join(known, ", "))));
}

std::vector<double> RunReader::field_values(const std::string& name, std::size_t index) const {
    const ParticleField& wanted = field(name);
    require_frame(index);
    const auto lock = hdf5_lock();
    return state_->reader.frame("/particles/all/" + wanted.name + "/value", index);
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
        throw InvalidInput(
            fmt::format("cannot start from '{}': it is a run of {} frames; give a sample (solve "
                        "--frame last continues from the end of a run)",
                        path.string(), reader.frame_count()));
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

namespace {

void require_hdf5_name(const fs::path& path) {
    if (path.extension() == ".xdmf")
        throw InvalidInput(
            fmt::format("cannot write '{}': name the HDF5 file (.h5), the .xdmf comes beside it", path.string()));
}

}  // namespace

struct RunWriter::State {
    State(const Packing& packing, const fs::path& path, const Provenance& provenance)
        : path(path), output(path), packing(packing), provenance(provenance) {}
    fs::path path;
    OutputFile output;
    Packing packing;
    Provenance provenance;
    std::vector<Frame> frames;
    std::map<std::string, Observable> observables;

    std::string failure() const { return fmt::format("cannot write '{}'", path.string()); }
};

RunWriter::RunWriter(const Packing& packing, const fs::path& path, const Provenance& provenance) {
    require_hdf5_name(path);
    require_sound_packing(packing, fmt::format("cannot write '{}'", path.string()));
    state_ = std::make_unique<State>(packing, path, provenance);
}

RunWriter::~RunWriter() = default;

void RunWriter::add_frame(const Frame& frame) {
    const std::string where =
        fmt::format("{}, frame {} (step {})", state_->failure(), state_->frames.size(), frame.step);
    if (frame.position.size() != state_->packing.size())
        throw InvalidInput(
            fmt::format("{}: {} positions for {} particles", where, frame.position.size(), state_->packing.size()));
    require_finite(frame.position, where);
    state_->frames.push_back(frame);
}

void RunWriter::add_observable(const std::string& name, const std::string& unit, std::int64_t step, double time,
                               double value) {
    Observable& curve = state_->observables.try_emplace(name, Observable{unit, {}, {}, {}}).first->second;
    curve.step.push_back(step);
    curve.time.push_back(time);
    curve.value.push_back(value);
}

void RunWriter::commit() {
    if (state_->frames.empty()) throw InvalidInput(state_->failure() + ": the run has no frame");
    RunShape shape{state_->frames.size(), {}, {}};
    for (const auto& [name, curve] : state_->observables)
        shape.curves.push_back({name, curve.unit, curve.value.size()});
    create_run_file(state_->packing, shape, state_->provenance, state_->output.path(), state_->path);
    RunFile file(state_->output.path(), state_->path);
    std::vector<double> times;
    for (const Frame& frame : state_->frames) {
        file.write_rows(position_field, times.size(), 0, {frame.position.front().data(), 3 * frame.position.size()});
        file.mark_frame(times.size(), frame.step, frame.time);
        times.push_back(frame.time);
    }
    for (const auto& [name, curve] : state_->observables)
        for (std::size_t i = 0; i < curve.value.size(); ++i)
            file.write_point(name, i, curve.step[i], curve.time[i], curve.value[i]);
    file.close();
    state_->output.flush();

    // A sidecar never stands beside a file it does not describe: the old one goes first, the new one comes last.
    remove_sidecar(state_->path);
    state_->output.commit();
    write_sidecar(state_->packing.size(), !state_->packing.object.empty(), times, {}, state_->path);
}

struct FieldWriter::State {
    State(const RunReader& run, std::size_t frames, std::vector<ParticleField> fields, const fs::path& path)
        : path(path),
          output(path),
          particles(run.packing().size()),
          has_objects(!run.packing().object.empty()),
          frames(frames),
          fields(std::move(fields)) {}
    fs::path path;
    OutputFile output;
    std::size_t particles;
    bool has_objects;
    std::size_t frames;
    std::vector<ParticleField> fields;
    std::optional<RunFile> file;
    std::vector<double> times;
};

FieldWriter::FieldWriter(const RunReader& run, const std::vector<std::size_t>& frames,
                         std::vector<ParticleField> fields, const fs::path& path, const Provenance& provenance) {
    require_hdf5_name(path);
    state_ = std::make_unique<State>(run, frames.size(), std::move(fields), path);
    RunShape shape{frames.size(), state_->fields, {}};
    for (const auto& [name, curve] : run.observables()) shape.curves.push_back({name, curve.unit, curve.value.size()});
    create_run_file(run.packing(), shape, provenance, state_->output.path(), path);
    state_->file.emplace(state_->output.path(), path);
    for (const auto& [name, curve] : run.observables())
        for (std::size_t i = 0; i < curve.value.size(); ++i)
            state_->file->write_point(name, i, curve.step[i], curve.time[i], curve.value[i]);
}

FieldWriter::~FieldWriter() = default;

void FieldWriter::add_frame(const Frame& frame, const std::vector<std::vector<double>>& values) {
    const std::size_t index = state_->times.size();
    if (index >= state_->frames || values.size() != state_->fields.size())
        throw std::logic_error("more frames or fields than announced");
    state_->file->write_rows(position_field, index, 0, {frame.position.front().data(), 3 * frame.position.size()});
    for (std::size_t f = 0; f < values.size(); ++f) {
        if (values[f].size() != state_->particles * static_cast<std::size_t>(state_->fields[f].components))
            throw std::logic_error("a field of another size than the particles");
        state_->file->write_rows(state_->fields[f], index, 0, values[f]);
    }
    state_->file->mark_frame(index, frame.step, frame.time);
    state_->times.push_back(frame.time);
}

void FieldWriter::commit() {
    if (state_->times.size() != state_->frames) throw std::logic_error("fewer frames than announced");
    state_->file->close();
    state_->output.flush();
    remove_sidecar(state_->path);
    state_->output.commit();
    write_sidecar(state_->particles, state_->has_objects, state_->times, state_->fields, state_->path);
}

void write_packing(const Packing& packing, const fs::path& path, const Provenance& provenance) {
    RunWriter writer(packing, path, provenance);
    writer.add_frame({0, 0.0, packing.position});
    writer.commit();
}

}  // namespace tomodem
