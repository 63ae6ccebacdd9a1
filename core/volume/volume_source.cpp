#include "core/volume/volume_source.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "core/volume/reading/locate.hpp"
#include "core/volume/reading/reading.hpp"

namespace tomodem {
namespace {

namespace fs = std::filesystem;
using formats::cannot_read;

struct TypeNames {
    VoxelType type;
    std::size_t bytes;
    std::array<const char*, 3> names;  // the first is shown
};

constexpr std::array<TypeNames, 10> types{{
    {VoxelType::uint8, 1, {"uint8", "u8", "uchar"}},
    {VoxelType::int8, 1, {"int8", "i8", "char"}},
    {VoxelType::uint16, 2, {"uint16", "u16", "ushort"}},
    {VoxelType::int16, 2, {"int16", "i16", "short"}},
    {VoxelType::uint32, 4, {"uint32", "u32", "uint"}},
    {VoxelType::int32, 4, {"int32", "i32", "int"}},
    {VoxelType::uint64, 8, {"uint64", "u64", "ulong"}},
    {VoxelType::int64, 8, {"int64", "i64", "long"}},
    {VoxelType::float32, 4, {"float32", "f32", "float"}},
    {VoxelType::float64, 8, {"float64", "f64", "double"}},
}};

/// Names or extensions of the formats that can do something, for messages.
std::string list_of(bool (*can)(const VolumeFormat&), bool extensions) {
    std::vector<std::string> texts;
    for (const VolumeFormat& format : volume_formats()) {
        if (!can(format)) continue;
        if (extensions)
            texts.insert(texts.end(), format.extensions.begin(), format.extensions.end());
        else
            texts.push_back(format.name);
    }
    return fmt::format("{}", fmt::join(texts, " or "));
}

bool has_slices(const VolumeFormat& format) {
    return bool(format.open_slices);
}

std::unique_ptr<VolumeSource> open_series(formats::Located found, const std::string& spec) {
    if (found.files.empty())
        cannot_read(spec, found.is_pattern ? "no file has a name like that"
                                           : fmt::format("the folder has no slice (no file ending in {})",
                                                         list_of(has_slices, true)));
    std::vector<fs::path> slices = formats::in_order_of_numbers(std::move(found.files), spec);
    const VolumeFormat* format = formats::format_of(slices.front());
    if (!format || !format->open_slices)
        cannot_read(spec, fmt::format("'{}' is no slice; a series of slices has the format {}",
                                      slices.front().filename().string(), list_of(has_slices, false)));
    return format->open_slices(std::move(slices), spec);
}

std::unique_ptr<VolumeSource> open_file(const fs::path& path, const std::string& dataset) {
    const VolumeFormat* format = formats::format_of(path);
    if (!dataset.empty() && !(format && format->has_datasets))
        cannot_read(path,
                    fmt::format("only a file of the format {} has a dataset ':{}'",
                                list_of([](const VolumeFormat& one) { return one.has_datasets; }, false), dataset));
    if (!format)
        cannot_read(path, fmt::format("it is of no known format ({}); for raw voxels give --raw-size and --raw-type",
                                      volume_format_names()));
    return format->open(path, dataset);
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
    return types[static_cast<std::size_t>(type)].bytes;
}

const char* name_of(VoxelType type) {
    return types[static_cast<std::size_t>(type)].names[0];
}

bool is_float(VoxelType type) {
    return type == VoxelType::float32 || type == VoxelType::float64;
}

std::optional<VoxelType> voxel_type(const std::string& name) {
    for (const auto& type : types)
        if (std::find(type.names.begin(), type.names.end(), name) != type.names.end()) return type.type;
    return {};
}

std::unique_ptr<VolumeSource> open_volume(const std::string& spec, const std::optional<RawLayout>& raw) {
    std::error_code error;
    if (raw) {
        if (!fs::exists(spec, error)) cannot_read(spec, "it does not exist");
        VolumeHeader header;
        header.format = "raw voxels";
        header.size = raw->size;
        header.type = raw->type;
        return formats::open_raw(std::move(header), {{spec}, raw->offset, raw->big_endian});
    }
    formats::Located found = formats::locate(spec);
    if (found.is_folder || found.is_pattern) return open_series(std::move(found), spec);
    if (found.files.empty()) cannot_read(spec, "it does not exist");
    return open_file(found.files.front(), found.dataset);
}

}  // namespace tomodem
