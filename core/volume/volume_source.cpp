#include "core/volume/volume_source.hpp"

#include <glob.h>

#include <algorithm>
#include <functional>

#include "core/volume/formats/formats.hpp"
#include "core/volume/formats/tiff_file.hpp"

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

/// FILE.h5:/path/of/dataset in two parts; the second is empty where there is none.
std::pair<std::string, std::string> split_dataset(const std::string& spec) {
    for (std::size_t colon = spec.find(':'); colon != std::string::npos; colon = spec.find(':', colon + 1))
        if (fs::is_regular_file(spec.substr(0, colon))) return {spec.substr(0, colon), spec.substr(colon + 1)};
    return {spec, ""};
}

bool is_slice(const fs::path& path) {
    const std::string extension = formats::lower_case(path.extension().string());
    return (extension == ".tif" || extension == ".tiff") && !path.filename().string().starts_with('.') &&
           fs::is_regular_file(path);
}

std::vector<fs::path> slices_of_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
        if (is_slice(it->path())) files.push_back(it->path());
    if (error) cannot_read(folder, error.message());
    if (files.empty()) cannot_read(folder, "the folder has no slice (no file ending in .tif or .tiff)");
    return files;
}

/// Files that a pattern with * ? [] names.
std::vector<fs::path> matches(const std::string& pattern) {
    glob_t found{};
    const std::unique_ptr<glob_t, decltype(&globfree)> guard(&found, &globfree);
    std::vector<fs::path> files;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
        for (std::size_t i = 0; i < found.gl_pathc; ++i)
            if (fs::is_regular_file(found.gl_pathv[i])) files.emplace_back(found.gl_pathv[i]);
    return files;
}

bool is_pattern(const std::string& spec) {
    return spec.find_first_of("*?[") != std::string::npos;
}

std::unique_ptr<VolumeSource> open_file(const std::string& spec) {
    const auto [name, dataset] = split_dataset(spec);
    const fs::path path = name;
    const std::string start = formats::first_bytes(path, 8);
    if (start.empty()) cannot_read(path, "the file is empty");
    if (start.starts_with("\x89HDF\r\n\x1a\n")) return formats::open_hdf5(path, dataset);
    if (!dataset.empty()) cannot_read(path, fmt::format("only an HDF5 file has a dataset ':{}'", dataset));
    if (formats::is_tiff(start)) return formats::open_tiff(path);
    if (start.starts_with("NRRD")) return formats::open_nrrd(path);
    static const std::map<std::string, std::unique_ptr<VolumeSource> (*)(const fs::path&)> by_extension{
        {".mhd", formats::open_metaimage}, {".mha", formats::open_metaimage}, {".vol", formats::open_esrf},
        {".raw", formats::open_esrf},      {".info", formats::open_esrf},     {".xml", formats::open_esrf},
        {".vdb", formats::open_vdb},       {".tif", formats::open_tiff},      {".tiff", formats::open_tiff}};
    if (const auto found = by_extension.find(formats::lower_case(path.extension().string()));
        found != by_extension.end())
        return found->second(path);
    cannot_read(
        path,
        "it is of no known format (TIFF, HDF5, MetaImage, NRRD, ESRF .vol or .raw with .info or .xml, OpenVDB); "
        "for raw voxels give --raw-size and --raw-type");
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
    const bool there = fs::exists(spec, error);
    if (raw) {
        if (!there) cannot_read(spec, "it does not exist");
        VolumeHeader header;
        header.format = "raw voxels";
        header.size = raw->size;
        header.type = raw->type;
        return formats::open_raw(std::move(header), {{spec}, raw->offset, raw->big_endian});
    }
    if (there && fs::is_directory(spec))
        return formats::open_tiff_slices(formats::in_order_of_numbers(slices_of_folder(spec), spec), spec);
    if (!there && is_pattern(spec)) {
        std::vector<fs::path> files = matches(spec);
        if (files.empty()) cannot_read(spec, "no file has a name like that");
        return formats::open_tiff_slices(formats::in_order_of_numbers(std::move(files), spec), spec);
    }
    if (!there && !fs::is_regular_file(split_dataset(spec).first)) cannot_read(spec, "it does not exist");
    return open_file(spec);
}

std::vector<fs::path> volume_files(const std::string& spec) {
    std::error_code error;
    if (fs::exists(spec, error)) {
        if (fs::is_directory(spec, error)) return {spec};
        try {
            return open_volume(spec)->header().files;
        } catch (const InvalidInput&) {
            return {spec};  // raw voxels, or damage that reading will name
        }
    }
    if (const fs::path file = split_dataset(spec).first; fs::is_regular_file(file)) return {file};
    if (is_pattern(spec))
        if (auto files = matches(spec); !files.empty()) return files;
    return {};
}

}  // namespace tomodem
