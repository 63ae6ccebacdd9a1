#include <fstream>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

struct NrrdHeader {
    std::map<std::string, std::string> fields;  // by name in lower case
    std::int64_t bytes = 0;                     // up to the voxels, where they follow

    /// The first of these fields that there is; empty if there is none.
    std::string text(std::initializer_list<const char*> names) const {
        for (const char* name : names)
            if (const auto found = fields.find(name); found != fields.end()) return found->second;
        return "";
    }
};

NrrdHeader read_header(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string line;
    if (!file || !std::getline(file, line) || !line.starts_with("NRRD000")) cannot_read(path, "it is no NRRD file");
    NrrdHeader header;
    for (int lines = 0; lines < 1000 && std::getline(file, line) && line.size() < 100'000; ++lines) {
        if (trimmed(line).empty()) {
            header.bytes = static_cast<std::int64_t>(file.tellg());
            return header;
        }
        const auto colon = line.find(':');
        if (line.starts_with('#') || colon == std::string::npos || line.compare(colon, 2, ":=") == 0) continue;
        header.fields[lower_case(trimmed(line.substr(0, colon)))] = trimmed(line.substr(colon + 1));
    }
    // A detached header may end with the file.
    if (!file.eof() || !(header.fields.contains("data file") || header.fields.contains("datafile")))
        cannot_read(path, "its NRRD header does not end; it is cut or damaged");
    return header;
}

VoxelType type_of(const fs::path& path, const std::string& name) {
    static const std::map<std::string, VoxelType> types{{"signed char", VoxelType::int8},
                                                        {"uchar", VoxelType::uint8},
                                                        {"unsigned char", VoxelType::uint8},
                                                        {"short", VoxelType::int16},
                                                        {"short int", VoxelType::int16},
                                                        {"signed short", VoxelType::int16},
                                                        {"ushort", VoxelType::uint16},
                                                        {"unsigned short", VoxelType::uint16},
                                                        {"unsigned short int", VoxelType::uint16},
                                                        {"int", VoxelType::int32},
                                                        {"signed int", VoxelType::int32},
                                                        {"uint", VoxelType::uint32},
                                                        {"unsigned int", VoxelType::uint32},
                                                        {"longlong", VoxelType::int64},
                                                        {"long long", VoxelType::int64},
                                                        {"ulonglong", VoxelType::uint64},
                                                        {"unsigned long long", VoxelType::uint64},
                                                        {"float", VoxelType::float32},
                                                        {"double", VoxelType::float64}};
    std::string plain = lower_case(name);
    if (plain.ends_with("_t")) plain.resize(plain.size() - 2);
    if (const auto found = types.find(plain); found != types.end()) return found->second;
    if (const auto found = voxel_type(plain)) return *found;
    cannot_read(path, fmt::format("its type '{}' is not read", name.substr(0, 40)));
}

/// "(1,0,0)" -> three numbers.
Vec3 vector_in(const fs::path& path, const std::string& field, const std::string& text) {
    std::string spaced;
    for (const char c : text) spaced += c == '(' || c == ')' || c == ',' ? ' ' : c;
    const auto words = words_of(spaced);
    if (words.size() != 3)
        cannot_read(path, fmt::format("its {} is '{}', expected (x,y,z)", field, text.substr(0, 60)));
    Vec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = number_in(path, field, words[axis]);
    return vector;
}

/// The unit of all axes, from "mm" "mm" "mm". Empty where there is none, or none that is a length.
std::optional<double> unit_in(const fs::path& path, const std::string& text) {
    std::string plain;
    for (const char c : text) plain += c == '"' ? ' ' : c;
    std::optional<double> unit;
    for (const auto& word : words_of(plain)) {
        const auto found = length_unit(word);
        if (!found) return {};
        if (unit && *unit != *found) cannot_read(path, "its axes have different units; save it with one");
        unit = found;
    }
    return unit;
}

/// The file with the voxels; the header itself where they follow it.
fs::path data_file(const fs::path& file, const NrrdHeader& nrrd) {
    const std::string data = nrrd.text({"data file", "datafile"});
    if (data.empty()) return file;
    if (lower_case(data).starts_with("list") || data.find('%') != std::string::npos)
        cannot_read(file, "its voxels lie in several files; save it with one data file");
    return file.parent_path() / data;
}

std::vector<fs::path> companions(const fs::path& file) {
    const fs::path data = data_file(file, read_header(file));
    return data == file ? std::vector{file} : std::vector{file, data};
}

Source open_nrrd(const fs::path& file, const std::string&) {
    const NrrdHeader nrrd = read_header(file);
    const auto text = [&](std::initializer_list<const char*> names) { return nrrd.text(names); };
    const std::int64_t dimensions = whole_number_in(file, "dimension", text({"dimension"}));
    const std::vector<std::string> sizes = words_of(text({"sizes"}));
    if ((dimensions != 2 && dimensions != 3) || static_cast<std::int64_t>(sizes.size()) != dimensions)
        cannot_read(file, fmt::format("it has {} dimensions and {} sizes; a volume has 3, one value a voxel",
                                      dimensions, sizes.size()));
    VolumeHeader header;
    header.format = "NRRD";
    header.type = type_of(file, text({"type"}));
    std::array<std::int64_t, 3> size{1, 1, 1};
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) size[axis] = whole_number_in(file, "sizes", sizes[axis]);
    check_size(file, size);
    for (int axis = 0; axis < 3; ++axis) header.size[axis] = static_cast<std::int32_t>(size[axis]);

    const auto unit = unit_in(file, text({"space units", "units"}));
    const std::vector<std::string> spacings = words_of(text({"spacings"}));
    const std::vector<std::string> directions = words_of(text({"space directions"}));
    bool along_axes = true;
    if (dimensions == 3 && (spacings.size() == 3 || directions.size() == 3)) {
        Vec3 spacing;
        for (int axis = 0; axis < 3; ++axis) {
            if (directions.size() == 3) {
                const Vec3 direction = vector_in(file, "space directions", directions[axis]);
                spacing[axis] = direction.norm();
                along_axes &= direction[axis] > 0.999999 * spacing[axis];
            } else {
                spacing[axis] = lower_case(spacings[axis]) == "nan" ? 0 : number_in(file, "spacings", spacings[axis]);
            }
        }
        if ((spacing.array() > 0).all()) {
            header.spacing = unit.value_or(1.0) * spacing;
            header.spacing_has_unit = unit.has_value();
            const std::string centre = text({"space origin"});
            if (unit && along_axes && !centre.empty())
                header.origin = *unit * vector_in(file, "space origin", centre) - *header.spacing / 2;
        }
    }

    RawVoxels where;
    where.big_endian = lower_case(text({"endian"})) == "big";
    const std::string encoding = lower_case(text({"encoding"}));
    where.deflated = encoding == "gzip" || encoding == "gz";
    if (!where.deflated && encoding != "raw")
        cannot_read(file, fmt::format("its encoding is '{}'; save it as raw or gzip", encoding.substr(0, 20)));
    where.files = {data_file(file, nrrd)};
    if (where.files.front() == file) where.offset = nrrd.bytes;
    const std::string skip = text({"byte skip", "byteskip"}), lines = text({"line skip", "lineskip"});
    if (!lines.empty() && whole_number_in(file, "line skip", lines) != 0)
        cannot_read(file, "it skips lines before its voxels; save it without");
    if (!skip.empty() && !where.deflated) {
        const std::int64_t bytes = whole_number_in(file, "byte skip", skip);
        const std::int64_t all = size[0] * size[1] * size[2] * static_cast<std::int64_t>(bytes_of(header.type));
        where.offset = bytes == -1 ? file_bytes(where.files.front()) - all : where.offset + bytes;
        if (where.offset < 0) cannot_read(where.files.front(), "it is shorter than its header says; it is cut");
    }
    return open_raw(std::move(header), where);
}

const RegisteredFormat nrrd_format{{
    .name = "NRRD",
    .extensions = {".nrrd", ".nhdr"},
    .sniff = [](const std::string& start, const fs::path&) { return start.starts_with("NRRD"); },
    .companions = companions,
    .open = open_nrrd,
}};

}  // namespace

}  // namespace tomodem::formats
