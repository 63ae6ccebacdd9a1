#include "core/packing/hdf5_file.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

/// Text of an attribute; empty where there is none.
std::string text_attribute(hid_t object, const char* name) {
    if (H5Aexists(object, name) <= 0) return "";
    const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "attribute");
    const Hdf5Handle type(H5Aget_type(attribute), H5Tclose, "attribute"), space(H5Aget_space(attribute), H5Sclose, "");
    if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return "";
    if (H5Tis_variable_str(type) > 0) {
        char* text = nullptr;
        if (H5Aread(attribute, type, &text) < 0 || !text) return "";
        const std::string result = text;
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, &text);
        return result;
    }
    const std::size_t size = H5Tget_size(type);
    if (size > 1 << 16) return "";
    std::string text(size, '\0');
    if (H5Aread(attribute, type, text.data()) < 0) return "";
    text.resize(std::min(text.find('\0'), text.size()));
    return text;
}

/// Whether every link of the path is there.
bool has_object(hid_t file, const std::string& path) {
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
        const std::string part = path.substr(0, end);
        if (part != "/" && !part.empty() && H5Lexists(file, part.c_str(), H5P_DEFAULT) <= 0) return false;
        if (end == std::string::npos) break;
    }
    return path == "/" || H5Oexists_by_name(file, path.c_str(), H5P_DEFAULT) > 0;
}

bool is_volume(hid_t file, const std::string& path) {
    const hid_t id = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
    if (id < 0) return false;
    const Hdf5Handle dataset(id, H5Dclose, ""), space(H5Dget_space(id), H5Sclose, ""),
        type(H5Dget_type(id), H5Tclose, "");
    const H5T_class_t kind = H5Tget_class(type);
    return H5Sget_simple_extent_ndims(space) == 3 && (kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_ENUM);
}

/// NeXus: the path that the `default` and `signal` attributes lead to; empty if they do not.
std::string nexus_default(hid_t file) {
    std::string path = "/";
    for (int depth = 0; depth < 16; ++depth) {
        const Hdf5Handle group(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, "");
        std::string next = text_attribute(group, "default");
        if (next.empty()) next = text_attribute(group, "signal");
        if (next.empty()) return "";
        path = next.starts_with('/') ? next : path + (path.ends_with('/') ? "" : "/") + next;
        if (!has_object(file, path)) return "";
        if (is_volume(file, path)) return path;
    }
    return "";
}

std::vector<std::string> volumes_of(hid_t file) {
    std::vector<std::string> names;
    H5Ovisit2(
        file, H5_INDEX_NAME, H5_ITER_INC,
        [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
            auto& list = *static_cast<std::vector<std::string>*>(out);
            if (info->type == H5O_TYPE_DATASET && list.size() < 1000) list.push_back(std::string("/") + name);
            return 0;
        },
        &names, H5O_INFO_BASIC);
    std::erase_if(names, [file](const std::string& name) { return !is_volume(file, name); });
    return names;
}

std::string find_dataset(const fs::path& path, hid_t file) {
    constexpr const char* dxchange = "/exchange/data";
    if (has_object(file, dxchange) && is_volume(file, dxchange)) return dxchange;
    if (const std::string found = nexus_default(file); !found.empty()) return found;
    if (has_object(file, "/h5md")) cannot_read(path, "it is a packing or a run (H5MD), not a volume");
    std::vector<std::string> names = volumes_of(file);
    if (names.size() == 1) return names.front();
    if (names.empty()) cannot_read(path, "it has no dataset of three dimensions (z, y, x) of numbers");
    const std::size_t count = names.size();
    names.resize(std::min<std::size_t>(count, 8));
    cannot_read(path,
                fmt::format("it has {} volumes; say which, as {}:{} (there are {}{})", count, path.filename().string(),
                            names.front(), fmt::join(names, ", "), count > 8 ? ", ..." : ""));
}

VoxelType type_of(const fs::path& path, hid_t dataset) {
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose, "");
    const std::size_t size = H5Tget_size(type);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind == H5T_FLOAT && size <= 4) return VoxelType::float32;
    if (kind == H5T_FLOAT && size == 8) return VoxelType::float64;
    // h5py writes bool as an enumeration of int8.
    const Hdf5Handle whole(kind == H5T_ENUM ? H5Tget_super(type) : H5Tcopy(type), H5Tclose, "");
    if (kind == H5T_INTEGER || kind == H5T_ENUM) {
        const bool sign = H5Tget_sign(whole) == H5T_SGN_2;
        if (size == 1) return sign ? VoxelType::int8 : VoxelType::uint8;
        if (size == 2) return sign ? VoxelType::int16 : VoxelType::uint16;
        if (size == 4) return sign ? VoxelType::int32 : VoxelType::uint32;
        if (size == 8) return sign ? VoxelType::int64 : VoxelType::uint64;
    }
    cannot_read(path, "its values are neither whole numbers of 8 to 64 bits nor 32 or 64-bit floats");
}

hid_t memory_type(VoxelType type) {
    switch (type) {
        case VoxelType::uint8:
            return H5T_NATIVE_UINT8;
        case VoxelType::int8:
            return H5T_NATIVE_INT8;
        case VoxelType::uint16:
            return H5T_NATIVE_UINT16;
        case VoxelType::int16:
            return H5T_NATIVE_INT16;
        case VoxelType::uint32:
            return H5T_NATIVE_UINT32;
        case VoxelType::int32:
            return H5T_NATIVE_INT32;
        case VoxelType::uint64:
            return H5T_NATIVE_UINT64;
        case VoxelType::int64:
            return H5T_NATIVE_INT64;
        case VoxelType::float32:
            return H5T_NATIVE_FLOAT;
        case VoxelType::float64:
            break;
    }
    return H5T_NATIVE_DOUBLE;
}

/// One number of a dataset and its unit in mm; empty where there is none.
std::optional<double> length_dataset(hid_t file, const std::string& path) {
    if (!has_object(file, path)) return {};
    const hid_t id = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
    if (id < 0) return {};
    const Hdf5Handle dataset(id, H5Dclose, ""), space(H5Dget_space(id), H5Sclose, "");
    const auto unit = length_unit(text_attribute(dataset, "units"));
    double value = 0;
    if (!unit || H5Sget_simple_extent_npoints(space) != 1 ||
        H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0 || !(value > 0))
        return {};
    return *unit * value;
}

/// Voxel size [mm]: ImageJ's and ilastik's element_size_um (z, y, x), or the pixels of an NXdetector beside the data:
/// a reconstruction's x and y have the pitch of the detector's columns, its slices that of the rows.
std::optional<Vec3> spacing_of(hid_t file, hid_t dataset, const std::string& path) {
    constexpr const char* name = "element_size_um";
    if (H5Aexists(dataset, name) > 0) {
        const Hdf5Handle attribute(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose, name);
        const Hdf5Handle space(H5Aget_space(attribute), H5Sclose, name);
        double zyx[3];
        if (H5Sget_simple_extent_npoints(space) == 3 && H5Aread(attribute, H5T_NATIVE_DOUBLE, zyx) >= 0 && zyx[0] > 0 &&
            zyx[1] > 0 && zyx[2] > 0)
            return Vec3(1e-3 * zyx[2], 1e-3 * zyx[1], 1e-3 * zyx[0]);
    }
    const std::string group = path.substr(0, path.rfind('/') + 1);
    const auto x = length_dataset(file, group + "x_pixel_size"), y = length_dataset(file, group + "y_pixel_size");
    if (x && y) return Vec3(*x, *x, *y);
    return {};
}

class Hdf5Source : public VolumeSource {
 public:
    Hdf5Source(const fs::path& path, const std::string& wanted)
        : lock_(hdf5_lock()),
          path_(path),
          failure_(fmt::format("cannot read volume '{}'", path.string())),
          file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, failure_),
          dataset_(open_dataset(wanted)) {
        header_.format = "HDF5 " + name_;
        const Hdf5Handle space(H5Dget_space(dataset_), H5Sclose, failure_);
        const int dimensions = H5Sget_simple_extent_ndims(space);
        if (dimensions != 3)
            cannot_read(path, fmt::format("{} has {} dimensions, a volume has 3 (z, y, x)", name_, dimensions));
        hsize_t zyx[3];
        H5Sget_simple_extent_dims(space, zyx, nullptr);
        constexpr hsize_t most = 1 << 30;
        for (hsize_t& edge : zyx) edge = std::min(edge, most);
        check_size(path, {std::int64_t(zyx[2]), std::int64_t(zyx[1]), std::int64_t(zyx[0])});
        for (int axis = 0; axis < 3; ++axis) header_.size[axis] = static_cast<std::int32_t>(zyx[2 - axis]);
        header_.type = type_of(path, dataset_);
        header_.spacing = spacing_of(file_, dataset_, name_);
        header_.spacing_has_unit = header_.spacing.has_value();
        lock_.unlock();
    }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const auto lock = hdf5_lock();
        const hsize_t start[3] = {hsize_t(k), hsize_t(window.y), hsize_t(window.x)};
        const hsize_t extent[3] = {hsize_t(count), hsize_t(window.height), hsize_t(window.width)};
        const Hdf5Handle space(H5Dget_space(dataset_), H5Sclose, failure_);
        const Hdf5Handle memory(H5Screate_simple(3, extent, nullptr), H5Sclose, failure_);
        hdf5_check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, extent, nullptr), failure_);
        hdf5_check(H5Dread(dataset_, memory_type(header_.type), memory, space, H5P_DEFAULT, voxels),
                   fmt::format("{}, slices {} to {} of {}", failure_, k, k + count - 1, name_));
    }

 private:
    Hdf5Handle open_dataset(const std::string& wanted) {
        name_ = wanted.empty() ? find_dataset(path_, file_) : wanted.starts_with('/') ? wanted : "/" + wanted;
        if (!has_object(file_, name_)) {
            const auto names = volumes_of(file_);
            cannot_read(path_, fmt::format("it has no dataset '{}'{}", name_,
                                           names.empty() ? "" : fmt::format(" (there is {})", fmt::join(names, ", "))));
        }
        // A layer of chunks stays in memory: without that, each is unpacked again for every slab that it reaches into.
        Hdf5Handle first(H5Dopen2(file_, name_.c_str(), H5P_DEFAULT), H5Dclose, failure_);
        const Hdf5Handle how(H5Dget_create_plist(first), H5Pclose, failure_);
        hsize_t chunk[3];
        const Hdf5Handle space(H5Dget_space(first), H5Sclose, failure_);
        if (H5Pget_layout(how) != H5D_CHUNKED || H5Sget_simple_extent_ndims(space) != 3 ||
            H5Pget_chunk(how, 3, chunk) != 3)
            return first;
        hsize_t zyx[3];
        H5Sget_simple_extent_dims(space, zyx, nullptr);
        const Hdf5Handle type(H5Dget_type(first), H5Tclose, failure_);
        constexpr double most = double(1 << 30);
        const double layer = double(chunk[0]) * (double(zyx[1]) + double(chunk[1])) *
                             (double(zyx[2]) + double(chunk[2])) * double(H5Tget_size(type));
        const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose, failure_);
        constexpr std::size_t slots = 100'003;
        hdf5_check(H5Pset_chunk_cache(access, slots, static_cast<std::size_t>(std::min(layer, most)), 1.0), failure_);
        return {H5Dopen2(file_, name_.c_str(), access), H5Dclose, failure_};
    }

    std::unique_lock<std::recursive_mutex> lock_;
    fs::path path_;
    std::string failure_, name_;
    Hdf5Handle file_, dataset_;
};

bool is_hdf5(const std::string& start) {
    return start.starts_with("\x89HDF\r\n\x1a\n");
}

const RegisteredFormat hdf5{{
    .name = "HDF5",
    .extensions = {".h5", ".hdf5"},
    .sniff = [](const std::string& start, const fs::path&) { return is_hdf5(start); },
    .open = [](const fs::path& file, const std::string& dataset) -> Source {
        if (!is_hdf5(first_bytes(file, 8))) cannot_read(file, "it is not an HDF5 file, or damaged");
        return in_own_process(file, "HDF5", [&] { return std::make_unique<Hdf5Source>(file, dataset); });
    },
    .has_datasets = true,
}};

}  // namespace

}  // namespace tomodem::formats
