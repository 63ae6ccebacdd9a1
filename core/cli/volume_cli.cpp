#include "core/cli/volume_cli.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "core/base/units.hpp"
#include "core/volume/volume_files.hpp"
#include "core/volume/volume_format.hpp"

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

/// The volume, and where its voxels are.
cli::Usage& add_place(cli::Usage& usage, VolumeRequest& request) {
    return usage
        .input("VOLUME", request.path, volume_files,
               fmt::format("Tomography: a file ({}), a folder of numbered slices, a pattern ('scan_*.tif'), or a "
                           "dataset (FILE.h5:/path).",
                           volume_format_names()))
        .option("--voxel-size", request.voxel_size, cli::Unit::length, cli::positive,
                "Edge of a voxel. Required if the file does not hold it; if the file does, a value given here must "
                "agree with it.")
        .flag("--override-voxel-size", request.override_voxel_size,
              "Take --voxel-size (and --slice-spacing) although the file says another size, as that of a program that "
              "did not know it.")
        .option("--slice-spacing", request.slice_spacing, cli::Unit::length, cli::positive,
                "Distance between slices; without it, the voxel size.")
        .option("--origin", request.origin,
                "World coordinates of the first voxel's corner, as 0mm,0mm,1.2mm; without it, those in the file, or 0.")
        .option(
            "--roi", request.roi,
            "Region of voxels to read, as x0:x1,y0:y1,z0:z1 counted from 0, without x1, y1 and z1; without it, all.")
        .option("--bin", request.bin,
                "Number of voxels along each axis that are merged into one, as 2 or 2x2x1; without it, none are.");
}

cli::Usage& add_raw(cli::Usage& usage, VolumeRequest& request) {
    return usage
        .option("--raw-size", request.raw_size,
                "Read the file as raw voxels, x fastest, of these numbers along x, y, z, as 200x200x100.")
        .option("--raw-type", request.raw_type,
                "Type of the raw voxels, required with --raw-size: uint8, int8, uint16 ... int64, float32, float64 (or "
                "u8, i8, u16 ... f64).")
        .choice("--raw-byte-order", request.raw_byte_order, {"little", "big"}, "Byte order of the raw voxels.")
        .option("--raw-offset", request.raw_offset, cli::Unit::none, cli::not_negative,
                "Number of bytes before the first raw voxel.");
}

}  // namespace

cli::Usage& add_volume(cli::Usage& usage, VolumeRequest& request) {
    add_place(usage, request)
        .option("--threshold", request.threshold,
                "Segment a grey image: voxels above this value get label 1, the others 0; 83,140 gives labels 0, 1, 2.")
        .option(
            "--otsu", request.otsu, cli::Unit::none, {1, 2},
            "Segment a grey image by this number of thresholds, found by Otsu's method (grey_histogram shows them).")
        .option("--relabel", request.relabel, "Labels to replace on reading, as 255=1,2=0; others stay.")
        .exclusive({"--threshold", "--otsu"});
    return add_raw(usage, request).threads();
}

cli::Usage& add_grey_volume(cli::Usage& usage, VolumeRequest& request) {
    add_place(usage, request);
    return add_raw(usage, request).threads();
}

LabelVolume read_volume(const VolumeRequest& request, const VolumeOptions& options, cli::Tool& tool) {
    LabelledImage image = read_image(request.path, options, tool.threads(), tool);
    for (std::size_t i = 0; i < image.otsu_thresholds.size(); ++i)
        tool.report(fmt::format("otsu_threshold_{}", i + 1), image.otsu_thresholds[i]);
    tool.report("image", image.description);
    return std::move(image.volume);
}

VolumeOptions volume_options(const VolumeRequest& request) {
    VolumeOptions options;
    options.voxel_size = {request.voxel_size, request.voxel_size,
                          request.slice_spacing > 0 ? request.slice_spacing : 0.0};
    if (request.slice_spacing > 0 && !(request.voxel_size > 0)) throw WrongUsage("--slice-spacing needs --voxel-size");
    if (request.override_voxel_size && !(request.voxel_size > 0))
        throw WrongUsage("--override-voxel-size needs the right size: --voxel-size");
    options.override_voxel_size = request.override_voxel_size;
    options.otsu_levels = static_cast<int>(request.otsu);
    if (!request.threshold.empty()) options.thresholds = parse_thresholds("--threshold", request.threshold);
    if (!request.bin.empty()) options.bin = parse_size("--bin", request.bin);
    if (!request.raw_size.empty() || !request.raw_type.empty()) {
        if (request.raw_size.empty() || request.raw_type.empty())
            throw WrongUsage("raw voxels need both --raw-size and --raw-type");
        const auto type = voxel_type(request.raw_type);
        if (!type)
            refuse("--raw-type", request.raw_type, "uint8, int8, uint16, int16, uint32, ..., float32 or float64");
        options.raw = {parse_size("--raw-size", request.raw_size), *type, request.raw_byte_order == "big",
                       request.raw_offset};
    }
    if (!request.origin.empty()) {
        const auto parts = split(request.origin, ',');
        if (parts.size() != 3) refuse("--origin", request.origin, "three lengths with unit, as 0mm,0mm,1.2mm");
        options.origin.emplace();
        for (int axis = 0; axis < 3; ++axis) try {
                (*options.origin)[axis] = units::length(parts[axis]);
            } catch (const InvalidInput& error) {
                throw WrongUsage(fmt::format("--origin: {}", error.what()));
            }
    }
    if (!request.relabel.empty()) options.relabel = parse_relabel("--relabel", request.relabel);
    if (!request.roi.empty()) options.region = parse_roi("--roi", request.roi);
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

std::map<std::string, std::string> parse_properties(const std::string& flag, const std::string& text) {
    std::map<std::string, std::string> properties;
    for (const auto part : split(text, ',')) {
        const auto equal = part.find('=');
        const std::string name(part.substr(0, equal));
        const bool plain = !name.empty() && std::all_of(name.begin(), name.end(),
                                                        [](unsigned char c) { return std::isalnum(c) || c == '_'; });
        if (equal == std::string_view::npos || equal + 1 == part.size() || !plain)
            refuse(flag, text, "NAME=VOLUME between commas, names of letters, digits and _, as temperature=t.tif");
        if (!properties.emplace(name, part.substr(equal + 1)).second)
            throw WrongUsage(fmt::format("{} '{}': {} is named twice", flag, text, name));
    }
    return properties;
}

std::vector<LabelObjects> parse_label_objects(const std::string& flag, const std::string& text) {
    const auto refuse = [&](const std::string& why) { throw WrongUsage(fmt::format("{} '{}': {}", flag, text, why)); };
    std::vector<LabelObjects> objects;
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    const auto number = [&](std::int32_t& value, char then) {
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc() || value < 1 ||
            (then == ',' ? stop != end && *stop != ',' : stop == end || *stop != then))
            refuse("expected FIRST:LAST=LABEL of whole numbers from 1, as 2:500=1");
        at = stop == end ? end : stop + 1;
    };
    do {
        LabelObjects range;
        number(range.first, ':');
        number(range.last, '=');
        number(range.species, ',');
        if (range.last < range.first) refuse("the last label is smaller than the first");
        for (const LabelObjects& other : objects)
            if (range.first <= other.last && other.first <= range.last) refuse("a label is in two ranges");
        objects.push_back(range);
    } while (at != end);
    std::sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return objects;
}

std::vector<std::int32_t> parse_labels(const std::string& flag, const std::string& text) {
    std::vector<std::int32_t> labels;
    for (const auto part : split(text, ','))
        labels.push_back(whole_number(flag, text, part, "labels between commas, as 2,3"));
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return labels;
}

Connectivity connectivity_of(const std::string& neighbours) {
    return neighbours == "6" ? Connectivity::faces : neighbours == "18" ? Connectivity::edges : Connectivity::corners;
}

std::array<VoxelIndex, 2> parse_roi(const std::string& flag, const std::string& text) {
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

std::vector<double> parse_numbers(const std::string& flag, const std::string& text, const std::string& expected) {
    std::vector<double> numbers;
    for (const auto part : split(text, ',')) {
        double value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
            refuse(flag, text, expected);
        numbers.push_back(value);
    }
    return numbers;
}

std::vector<double> parse_thresholds(const std::string& flag, const std::string& text) {
    const std::string expected = "numbers that rise, as 83 or 83,140";
    const std::vector<double> thresholds = parse_numbers(flag, text, expected);
    if (std::adjacent_find(thresholds.begin(), thresholds.end(), std::greater_equal<>()) != thresholds.end())
        refuse(flag, text, expected);
    return thresholds;
}

VoxelIndex parse_size(const std::string& flag, const std::string& text) {
    const std::string expected = flag == "--bin" ? "a number of voxels, as 2, or three, as 2x2x1"
                                                 : "a number of voxels, as 100, or three, as 100x100x150";
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
