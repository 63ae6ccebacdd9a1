#include "core/volume_cli.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/units.hpp"

namespace tomodem {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(' ');
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(trimmed(text.substr(0, end)));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

[[noreturn]] void refuse(const std::string& flag, const std::string& text, const std::string& expected) {
    throw WrongUsage(fmt::format("{} '{}': expected {}", flag, text, expected));
}

std::int32_t whole_number(const std::string& flag, const std::string& text, std::string_view part,
                          const std::string& expected) {
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) refuse(flag, text, expected);
    return value;
}

}  // namespace

cli::Usage& add_volume(cli::Usage& usage, VolumeRequest& request) {
    return usage.input("volume", request.path, "segmented volume: multipage TIFF, or a folder of numbered slices")
        .required("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive, "edge of a voxel")
        .option("--slice-spacing", request.slice_spacing, cli::Unit::length, cli::positive,
                "distance of the slices, where it is not the voxel size")
        .option("--origin", request.origin, "world coordinates of the first voxel's corner, as 0mm,0mm,1.2mm")
        .option("--threshold", request.threshold, cli::Unit::none, cli::any,
                "the image is grey: voxels above this value become label 1, the others 0 (void)")
        .option("--relabel", request.relabel, "labels to rename on reading, as 255=1,2=0")
        .option("--crop", request.crop, "voxels to keep, as x0:x1,y0:y1,z0:z1 counted from 0, the second not included");
}

VolumeOptions volume_options(const VolumeRequest& request) {
    VolumeOptions options;
    const double z = request.slice_spacing > 0 ? request.slice_spacing : request.voxel_size;
    options.voxel_size = {request.voxel_size, request.voxel_size, z};
    if (cli::given("--threshold")) options.threshold = request.threshold;
    if (!request.origin.empty()) {
        const auto parts = split(request.origin, ',');
        if (parts.size() != 3) refuse("--origin", request.origin, "three lengths with unit, as 0mm,0mm,1.2mm");
        for (int axis = 0; axis < 3; ++axis) try {
                options.origin[axis] = units::length(parts[axis]);
            } catch (const InvalidInput& error) {
                throw WrongUsage(fmt::format("--origin: {}", error.what()));
            }
    }
    if (!request.relabel.empty()) options.relabel = parse_relabel("--relabel", request.relabel);
    if (!request.crop.empty()) options.region = parse_crop("--crop", request.crop);
    return options;
}

std::map<std::int32_t, std::int32_t> parse_relabel(const std::string& flag, const std::string& text) {
    const std::string expected = "pairs OLD=NEW of whole numbers, as 255=1,2=0";
    std::map<std::int32_t, std::int32_t> relabel;
    for (const auto part : split(text, ',')) {
        const auto sides = split(part, '=');
        if (sides.size() != 2) refuse(flag, text, expected);
        const std::int32_t from = whole_number(flag, text, sides[0], expected);
        if (!relabel.emplace(from, whole_number(flag, text, sides[1], expected)).second)
            throw WrongUsage(fmt::format("{} '{}': label {} is named twice", flag, text, from));
    }
    return relabel;
}

std::map<std::int32_t, std::string> parse_label_names(const std::string& flag, const std::string& text) {
    const std::string expected = "pairs LABEL=NAME, as 1=matrix,2=inclusion";
    std::map<std::int32_t, std::string> names;
    for (const auto part : split(text, ',')) {
        const auto sides = split(part, '=');
        if (sides.size() != 2 || sides[1].empty()) refuse(flag, text, expected);
        const std::int32_t label = whole_number(flag, text, sides[0], expected);
        for (const auto& [other, name] : names)
            if (name == sides[1])
                throw WrongUsage(
                    fmt::format("{} '{}': labels {} and {} have the same name; make them one with --relabel", flag,
                                text, other, label));
        if (!names.emplace(label, sides[1]).second)
            throw WrongUsage(fmt::format("{} '{}': label {} is named twice", flag, text, label));
    }
    return names;
}

std::vector<std::int32_t> parse_labels(const std::string& flag, const std::string& text) {
    std::vector<std::int32_t> labels;
    for (const auto part : split(text, ','))
        labels.push_back(whole_number(flag, text, part, "labels between commas, as 2,3"));
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return labels;
}

std::array<VoxelIndex, 2> parse_crop(const std::string& flag, const std::string& text) {
    const std::string expected = "x0:x1,y0:y1,z0:z1 in voxels with 0 <= x0 < x1, as 0:100,0:100,50:150";
    const auto parts = split(text, ',');
    if (parts.size() != 3) refuse(flag, text, expected);
    std::array<VoxelIndex, 2> region;
    for (int axis = 0; axis < 3; ++axis) {
        const auto ends = split(parts[axis], ':');
        if (ends.size() != 2) refuse(flag, text, expected);
        const std::int32_t first = whole_number(flag, text, ends[0], expected);
        const std::int32_t end = whole_number(flag, text, ends[1], expected);
        if (first < 0 || end <= first) refuse(flag, text, expected);
        region[0][axis] = first;
        region[1][axis] = end - first;
    }
    return region;
}

VoxelIndex parse_size(const std::string& flag, const std::string& text) {
    const std::string expected = "a number of voxels, as 100, or three, as 100x100x150";
    const auto parts = split(text, 'x');
    if (parts.size() != 1 && parts.size() != 3) refuse(flag, text, expected);
    VoxelIndex size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        size[axis] = whole_number(flag, text, parts[parts.size() == 1 ? 0 : axis], expected);
        if (size[axis] < 1) refuse(flag, text, expected);
    }
    return size;
}

}  // namespace tomodem
