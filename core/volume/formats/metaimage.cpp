#include <algorithm>
#include <fstream>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

struct MetaHeader {
    std::map<std::string, std::string> fields;  // by key in lower case
    std::vector<std::string> list;              // lines behind "ElementDataFile = LIST"
    std::int64_t bytes = 0;                     // up to the voxels, where they follow

    std::string text(const std::string& key, const std::string& otherwise) const {
        const auto found = fields.find(key);
        return found == fields.end() ? otherwise : found->second;
    }
};

MetaHeader read_header(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) cannot_read(path, "it cannot be opened; check its permissions");
    MetaHeader header;
    constexpr std::size_t longest_line = 4096;
    for (std::string line; header.fields.size() < 200 && std::getline(file, line);) {
        const auto equal = line.find('=');
        if (equal == std::string::npos || line.size() > longest_line) break;
        const std::string key = lower_case(trimmed(line.substr(0, equal)));
        header.fields[key] = trimmed(line.substr(equal + 1));
        if (key != "elementdatafile") continue;
        header.bytes = static_cast<std::int64_t>(file.tellg());
        if (lower_case(header.fields[key]).starts_with("list"))
            while (std::getline(file, line) && line.size() < longest_line)
                if (!trimmed(line).empty()) header.list.push_back(trimmed(line));
        return header;
    }
    cannot_read(path, "its MetaImage header has no ElementDataFile line; it is cut or damaged");
}

VoxelType type_of(const fs::path& path, const std::string& name) {
    static const std::map<std::string, VoxelType> types{
        {"met_uchar", VoxelType::uint8},       {"met_char", VoxelType::int8},       {"met_ushort", VoxelType::uint16},
        {"met_short", VoxelType::int16},       {"met_uint", VoxelType::uint32},     {"met_int", VoxelType::int32},
        {"met_ulong_long", VoxelType::uint64}, {"met_long_long", VoxelType::int64}, {"met_float", VoxelType::float32},
        {"met_double", VoxelType::float64}};
    const auto found = types.find(lower_case(name));
    if (found == types.end()) cannot_read(path, fmt::format("its ElementType '{}' is not read", name.substr(0, 40)));
    return found->second;
}

/// Replaces "%04d" by a number. Nothing else of printf is allowed in names.
std::string numbered(const fs::path& path, const std::string& pattern, std::int64_t number) {
    const auto percent = pattern.find('%');
    const auto letter = percent == std::string::npos ? percent : pattern.find('d', percent);
    if (letter == std::string::npos || letter - percent > 4)
        cannot_read(path, fmt::format("its file pattern '{}' has no %d", pattern.substr(0, 60)));
    const std::string width = pattern.substr(percent + 1, letter - percent - 1);
    if (!std::all_of(width.begin(), width.end(), [](unsigned char c) { return std::isdigit(c); }))
        cannot_read(path, fmt::format("its file pattern '{}' is not NAME%04d", pattern.substr(0, 60)));
    const int wanted = width.empty() ? 0 : std::stoi(width);
    const std::string digits =
        width.starts_with('0') ? fmt::format("{:0{}d}", number, wanted) : fmt::format("{:{}d}", number, wanted);
    return pattern.substr(0, percent) + digits + pattern.substr(letter + 1);
}

std::array<std::int64_t, 3> size_of(const fs::path& file, const MetaHeader& meta) {
    const std::int64_t dimensions = whole_number_in(file, "NDims", meta.text("ndims", ""));
    const std::vector<std::string> sizes = words_of(meta.text("dimsize", ""));
    if ((dimensions != 2 && dimensions != 3) || static_cast<std::int64_t>(sizes.size()) != dimensions)
        cannot_read(
            file, fmt::format("it has {} dimensions and {} sizes (DimSize); a volume has 3", dimensions, sizes.size()));
    std::array<std::int64_t, 3> size{1, 1, 1};
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) size[axis] = whole_number_in(file, "DimSize", sizes[axis]);
    check_size(file, size);
    return size;
}

/// The files with the voxels; the header itself where they follow it.
std::vector<fs::path> data_files(const fs::path& file, const MetaHeader& meta, std::int64_t slices) {
    const fs::path folder = file.parent_path();
    const std::string data = meta.text("elementdatafile", "");
    const std::vector<std::string> words = words_of(data);
    if (lower_case(data) == "local") return {file};
    std::vector<fs::path> files;
    if (!meta.list.empty()) {
        for (const auto& name : meta.list) files.push_back(folder / name);
    } else if (words.size() >= 3 && data.find('%') != std::string::npos) {
        const std::int64_t first = whole_number_in(file, "ElementDataFile", words[1]);
        const std::int64_t last = whole_number_in(file, "ElementDataFile", words[2]);
        const std::int64_t step = words.size() > 3 ? whole_number_in(file, "ElementDataFile", words[3]) : 1;
        if (step < 1 || last < first || (last - first) / step >= slices)
            cannot_read(file, fmt::format("its file pattern '{}' does not fit {} slices", data.substr(0, 60), slices));
        for (std::int64_t number = first; number <= last; number += step)
            files.push_back(folder / numbered(file, words[0], number));
    } else if (!data.empty() && lower_case(data) != "list") {
        files = {folder / data};
    }
    if (files.empty()) cannot_read(file, "its header names no data file (ElementDataFile)");
    return files;
}

std::vector<fs::path> companions(const fs::path& file) {
    const MetaHeader meta = read_header(file);
    std::vector<fs::path> files = data_files(file, meta, size_of(file, meta)[2]);
    if (files.front() != file) files.insert(files.begin(), file);
    return files;
}

Source open_metaimage(const fs::path& file, const std::string&) {
    const MetaHeader meta = read_header(file);
    const auto text = [&](const std::string& key, const std::string& otherwise) { return meta.text(key, otherwise); };
    const auto is_true = [&](const std::string& key) { return lower_case(text(key, "false")).starts_with('t'); };
    const std::array<std::int64_t, 3> size = size_of(file, meta);
    if (const auto channels = whole_number_in(file, "ElementNumberOfChannels", text("elementnumberofchannels", "1"));
        channels != 1)
        cannot_read(file, fmt::format("it has {} values a voxel; save it with one", channels));
    if (text("binarydata", "true")[0] != 'T' && text("binarydata", "true")[0] != 't')
        cannot_read(file, "its voxels are written as text; save it with binary data");

    VolumeHeader header;
    header.format = "MetaImage";
    header.type = type_of(file, text("elementtype", ""));
    for (int axis = 0; axis < 3; ++axis) header.size[axis] = static_cast<std::int32_t>(size[axis]);

    const std::vector<std::string> spacing = words_of(text("elementspacing", text("elementsize", "")));
    if (spacing.size() == 3) {
        const auto unit = length_unit(text("distanceunits", ""));
        header.spacing_has_unit = unit.has_value();
        header.spacing.emplace();
        for (int axis = 0; axis < 3; ++axis) {
            const double edge = unit.value_or(1.0) * number_in(file, "ElementSpacing", spacing[axis]);
            if (!(edge > 0)) cannot_read(file, fmt::format("its ElementSpacing is {:g}; it must be more than 0", edge));
            (*header.spacing)[axis] = edge;
        }
        const std::vector<std::string> centre = words_of(text("offset", text("position", text("origin", ""))));
        if (unit && centre.size() == 3) {
            header.origin.emplace();
            for (int axis = 0; axis < 3; ++axis)
                (*header.origin)[axis] = *unit * number_in(file, "Offset", centre[axis]) - (*header.spacing)[axis] / 2;
        }
    }

    RawVoxels where;
    where.big_endian = is_true("binarydatabyteordermsb") || is_true("elementbyteordermsb");
    where.deflated = is_true("compresseddata");
    const std::int64_t header_bytes = whole_number_in(file, "HeaderSize", text("headersize", "0"));
    where.files = data_files(file, meta, size[2]);
    if (where.files.front() == file) where.offset = meta.bytes;
    if (where.deflated && where.files.size() > 1)
        cannot_read(file, "it has compressed voxels in several files; save it as one .mha");
    if (header_bytes > 0 && where.files.front() != file) where.offset = header_bytes;
    if (header_bytes == -1 && !where.deflated) {
        // The voxels are what the file ends with.
        const std::int64_t slices = size[2] / static_cast<std::int64_t>(where.files.size());
        where.offset = file_bytes(where.files.front()) -
                       size[0] * size[1] * slices * static_cast<std::int64_t>(bytes_of(header.type));
        if (where.offset < 0) cannot_read(where.files.front(), "it is shorter than its header says; it is cut");
    }
    return open_raw(std::move(header), where);
}

const RegisteredFormat metaimage{{
    .name = "MetaImage",
    .extensions = {".mhd", ".mha"},
    .companions = companions,
    .open = open_metaimage,
}};

}  // namespace
}  // namespace tomodem::formats
