#include "core/packing/hdf5_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/base/error.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are handed to HDF5 as rows of three numbers");

/// What HDF5 says about its last failure: the text nearest to the cause.
std::string reason() {
    std::string reason;
    H5Ewalk2(
        H5E_DEFAULT, H5E_WALK_UPWARD,
        [](unsigned, const H5E_error2_t* entry, void* out) -> herr_t {
            auto& text = *static_cast<std::string*>(out);
            if (text.empty() && entry->desc != nullptr) text = entry->desc;
            return 0;
        },
        &reason);
    if (reason.find("No space left") != std::string::npos) return "no space left on the disk";
    if (reason.find("quota") != std::string::npos) return "the disk quota is used up";
    return reason.empty() ? "HDF5 gives no reason" : reason;
}

std::size_t longest(const std::vector<std::string>& texts) {
    std::size_t size = 0;
    for (const std::string& text : texts) size = std::max(size, text.size());
    return size;
}

std::string padded(const std::vector<std::string>& texts) {
    const std::size_t size = std::max<std::size_t>(longest(texts), 1);
    std::string all;
    for (const std::string& text : texts) (all += text).append(size - text.size(), '\0');
    return all;
}

/// The strings that `read(type in memory, buffer)` delivers, of fixed or variable length.
template <class Read>
std::vector<std::string> texts(hid_t type, hid_t space, const std::string& failure, const Read& read) {
    if (H5Tget_class(type) != H5T_STRING) throw InvalidInput(failure + " does not hold text");
    const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    std::vector<std::string> all(count);
    if (count == 0) return all;
    if (H5Tis_variable_str(type) > 0) {
        std::vector<char*> pointers(count, nullptr);
        hdf5_check(read(type, pointers.data()), failure);
        for (std::size_t i = 0; i < count; ++i)
            if (pointers[i] != nullptr) all[i] = pointers[i];
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
    } else {
        const std::size_t size = H5Tget_size(type);
        std::string buffer(count * size, '\0');
        hdf5_check(read(type, buffer.data()), failure);
        for (std::size_t i = 0; i < count; ++i) {
            all[i] = buffer.substr(i * size, size);
            all[i].resize(std::min(all[i].find('\0'), all[i].size()));
        }
    }
    return all;
}

}  // namespace

std::unique_lock<std::recursive_mutex> hdf5_lock() {
    static std::recursive_mutex mutex;
    std::unique_lock lock(mutex);
    static const bool silenced = [] {
        H5dont_atexit();  // what could not be written when the disk was full must not be tried again at exit
        return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
    }();
    (void)silenced;
    return lock;
}

void hdf5_check(herr_t status, const std::string& failure) {
    if (status < 0) throw InvalidInput(fmt::format("{}: {}", failure, reason()));
}

template <>
hid_t hdf5_native<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t hdf5_native<std::int32_t>() {
    return H5T_NATIVE_INT32;
}
template <>
hid_t hdf5_native<std::int64_t>() {
    return H5T_NATIVE_INT64;
}

Hdf5Handle::Hdf5Handle(hid_t id, Close close, const std::string& failure) : id_(id), close_(close) {
    if (id < 0) throw InvalidInput(fmt::format("{}: {}", failure, reason()));
}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
}

Hdf5Handle::~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
}

bool Hdf5Handle::close() {
    return close_(std::exchange(id_, -1)) >= 0;
}

Hdf5Writer::Hdf5Writer(const fs::path& where, const fs::path& shown, Start start)
    : failure_(fmt::format("cannot write '{}'", shown.string())), file_(opened(where, start)) {}

Hdf5Handle Hdf5Writer::group(hid_t parent, const char* name) {
    const Hdf5Handle creation = untimed(H5P_GROUP_CREATE);
    return {H5Gcreate2(parent, name, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, failure_};
}

void Hdf5Writer::attribute(hid_t object, const char* name, const std::string& text) {
    const Hdf5Handle type = text_type(text.size());
    Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose, failure_);
    Hdf5Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failure_);
    hdf5_check(H5Awrite(attribute, type, padded({text}).data()), failure_);
}

void Hdf5Writer::attribute(hid_t object, const char* name, const std::vector<std::string>& texts) {
    const Hdf5Handle type = text_type(longest(texts));
    const hsize_t count = texts.size();
    Hdf5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, failure_);
    Hdf5Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failure_);
    hdf5_check(H5Awrite(attribute, type, padded(texts).data()), failure_);
}

void Hdf5Writer::text_dataset(hid_t parent, const char* name, const std::vector<std::string>& texts, bool list) {
    const Hdf5Handle type = text_type(longest(texts));
    const hsize_t count = texts.size();
    Hdf5Handle space(list ? H5Screate_simple(1, &count, nullptr) : H5Screate(H5S_SCALAR), H5Sclose, failure_);
    const Hdf5Handle creation = untimed(H5P_DATASET_CREATE);
    Hdf5Handle dataset(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose, failure_);
    if (count > 0) hdf5_check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded(texts).data()), failure_);
}

Hdf5Handle Hdf5Writer::reserved(hid_t parent, const char* name, const Hdf5Shape& shape, hid_t type, const void* fill) {
    const Hdf5Handle creation = untimed(H5P_DATASET_CREATE);
    hdf5_check(H5Pset_layout(creation, H5D_CONTIGUOUS), failure_);
    hdf5_check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), failure_);
    hdf5_check(H5Pset_fill_time(creation, fill ? H5D_FILL_TIME_ALLOC : H5D_FILL_TIME_NEVER), failure_);
    if (fill) hdf5_check(H5Pset_fill_value(creation, type, fill), failure_);
    Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, failure_);
    return {H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose, failure_};
}

void Hdf5Writer::remove_group(const char* name) {
    if (H5Lexists(file_, name, H5P_DEFAULT) > 0) hdf5_check(H5Ldelete(file_, name, H5P_DEFAULT), failure_);
}

void Hdf5Writer::link(const char* existing, hid_t parent, const char* name) {
    hdf5_check(H5Lcreate_hard(file_, existing, parent, name, H5P_DEFAULT, H5P_DEFAULT), failure_);
}

void Hdf5Writer::frame_view(hid_t parent, const std::string& name, const std::string& source, hsize_t index,
                            const hsize_t (&whole)[3]) {
    const hsize_t offset[] = {index, 0, 0};
    const hsize_t count[] = {1, whole[1], whole[2]};
    Hdf5Handle slab(H5Screate_simple(3, whole, nullptr), H5Sclose, failure_);
    hdf5_check(H5Sselect_hyperslab(slab, H5S_SELECT_SET, offset, nullptr, count, nullptr), failure_);
    Hdf5Handle view(H5Screate_simple(2, count + 1, nullptr), H5Sclose, failure_);
    const Hdf5Handle creation = untimed(H5P_DATASET_CREATE);
    hdf5_check(H5Pset_virtual(creation, view, ".", source.c_str(), slab), failure_);
    Hdf5Handle dataset(H5Dcreate2(parent, name.c_str(), H5T_IEEE_F64LE, view, H5P_DEFAULT, creation, H5P_DEFAULT),
                       H5Dclose, failure_);
}

void Hdf5Writer::close() {
    if (!file_.close()) throw InvalidInput(fmt::format("{}: {}", failure_, reason()));
}

Hdf5Handle Hdf5Writer::opened(const fs::path& where, Start start) {
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failure_);
    hdf5_check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110), failure_);  // views need 1.10
    hdf5_check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), failure_);
    hdf5_check(H5Pset_file_locking(access, false, true), failure_);  // the part file is ours alone
    if (start == Start::from_existing) return {H5Fopen(where.c_str(), H5F_ACC_RDWR, access), H5Fclose, failure_};
    const Hdf5Handle creation = untimed(H5P_FILE_CREATE);
    return {H5Fcreate(where.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, failure_};
}

Hdf5Handle Hdf5Writer::untimed(hid_t property_class) {
    Hdf5Handle list(H5Pcreate(property_class), H5Pclose, failure_);
    hdf5_check(H5Pset_obj_track_times(list, false), failure_);
    return list;
}

Hdf5Handle Hdf5Writer::text_type(std::size_t size) {
    Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, failure_);
    hdf5_check(H5Tset_size(type, std::max<std::size_t>(size, 1)), failure_);
    hdf5_check(H5Tset_strpad(type, H5T_STR_NULLPAD), failure_);
    hdf5_check(H5Tset_cset(type, H5T_CSET_UTF8), failure_);
    return type;
}

Hdf5Filler::Hdf5Filler(const fs::path& where, const fs::path& shown, MPI_Comm processes)
    : failure_(fmt::format("cannot write '{}'", shown.string())), processes_(processes), file_(opened(where)) {}

Hdf5Handle Hdf5Filler::opened(const fs::path& where) {
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failure_);
    hdf5_check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), failure_);
    hdf5_check(H5Pset_file_locking(access, false, true), failure_);
    if (processes_ != MPI_COMM_NULL) hdf5_check(H5Pset_fapl_mpio(access, processes_, MPI_INFO_NULL), failure_);
    return {H5Fopen(where.c_str(), H5F_ACC_RDWR, access), H5Fclose, failure_};
}

void Hdf5Filler::write(const std::string& path, const Hdf5Shape& start, const Hdf5Shape& shape, hid_t type,
                       const void* data, Call call) {
    auto found = datasets_.find(path);
    if (found == datasets_.end())
        found = datasets_
                    .emplace(path, Hdf5Handle(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose,
                                              fmt::format("{}: {}", failure_, path)))
                    .first;
    Hdf5Handle target(H5Dget_space(found->second), H5Sclose, failure_);
    Hdf5Handle source(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, failure_);
    const bool empty = std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end();
    if (empty) {
        hdf5_check(H5Sselect_none(target), failure_);
        hdf5_check(H5Sselect_none(source), failure_);
    } else {
        hdf5_check(H5Sselect_hyperslab(target, H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr), failure_);
    }
    Hdf5Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose, failure_);
    if (processes_ != MPI_COMM_NULL)
        hdf5_check(H5Pset_dxpl_mpio(transfer, call == Call::together ? H5FD_MPIO_COLLECTIVE : H5FD_MPIO_INDEPENDENT),
                   failure_);
    const double nothing = 0;
    hdf5_check(H5Dwrite(found->second, type, source, target, transfer, empty ? &nothing : data), failure_);
}

void Hdf5Filler::flush() {
    hdf5_check(H5Fflush(file_, H5F_SCOPE_LOCAL), failure_);
}

void Hdf5Filler::close() {
    datasets_.clear();
    if (!file_.close()) throw InvalidInput(fmt::format("{}: {}", failure_, reason()));
}

Hdf5Reader::Hdf5Reader(const fs::path& path)
    : failure_(fmt::format("cannot read '{}'", path.string())), file_(opened(path)) {}

void Hdf5Reader::fail(const std::string& what) const {
    throw InvalidInput(failure_ + ": " + what);
}

bool Hdf5Reader::exists(const std::string& path) const {
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
        if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
        if (end == std::string::npos) return true;
    }
}

bool Hdf5Reader::is_group(const std::string& path) const {
    H5O_info_t info;
    return exists(path) && H5Oget_info_by_name2(file_, path.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
           info.type == H5O_TYPE_GROUP;
}

std::vector<std::string> Hdf5Reader::members(const std::string& path) const {
    Hdf5Handle group(H5Gopen2(file_, path.c_str(), H5P_DEFAULT), H5Gclose, at(path));
    std::vector<std::string> names;
    hsize_t index = 0;
    hdf5_check(H5Literate(
                   group, H5_INDEX_NAME, H5_ITER_INC, &index,
                   [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
                       static_cast<std::vector<std::string>*>(out)->push_back(name);
                       return 0;
                   },
                   &names),
               at(path));
    return names;
}

Hdf5Handle Hdf5Reader::dataset(const std::string& path) const {
    if (!exists(path)) fail(fmt::format("it has no {}: not a packing or run of tomodem", path));
    return {H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, at(path)};
}

Hdf5Shape Hdf5Reader::shape(hid_t dataset, const std::string& path) const {
    Hdf5Handle space(H5Dget_space(dataset), H5Sclose, at(path));
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0) fail(path + " has no shape");
    Hdf5Shape shape(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    return shape;
}

Vec3 Hdf5Reader::vector(const std::string& path) const {
    const auto values = array<double>(path);
    if (values.size() != 3) fail(fmt::format("{} has {} values instead of 3", path, values.size()));
    return {values[0], values[1], values[2]};
}

std::vector<std::pair<std::string, double>> Hdf5Reader::number_attributes(const std::string& object) const {
    const Hdf5Handle opened(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose, at(object));
    std::vector<std::pair<std::string, double>> numbers;
    hdf5_check(H5Aiterate2(
                   opened, H5_INDEX_NAME, H5_ITER_INC, nullptr,
                   [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
                       static_cast<std::vector<std::pair<std::string, double>>*>(out)->emplace_back(name, 0.0);
                       return 0;
                   },
                   &numbers),
               at(object));
    std::erase_if(numbers, [&](auto& entry) {
        const auto attribute = open_attribute(object, entry.first.c_str());
        const Hdf5Handle type(H5Aget_type(*attribute), H5Tclose, at(object));
        const Hdf5Handle space(H5Aget_space(*attribute), H5Sclose, at(object));
        const H5T_class_t kind = H5Tget_class(type);
        if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_npoints(space) != 1) return true;
        hdf5_check(H5Aread(*attribute, H5T_NATIVE_DOUBLE, &entry.second), at(object));
        return false;
    });
    return numbers;
}

std::vector<std::string> Hdf5Reader::text_attribute(const std::string& object, const char* name) const {
    const auto attribute = open_attribute(object, name);
    if (!attribute) return {};
    Hdf5Handle type(H5Aget_type(*attribute), H5Tclose, at(object));
    Hdf5Handle space(H5Aget_space(*attribute), H5Sclose, at(object));
    const hid_t id = *attribute;
    return texts(type, space, at(object), [id](hid_t memory, void* out) { return H5Aread(id, memory, out); });
}

std::vector<std::string> Hdf5Reader::text_dataset(const std::string& path) const {
    if (!exists(path)) return {};
    const Hdf5Handle set = dataset(path);
    Hdf5Handle type(H5Dget_type(set), H5Tclose, at(path));
    Hdf5Handle space(H5Dget_space(set), H5Sclose, at(path));
    return texts(type, space, at(path),
                 [&](hid_t memory, void* out) { return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, out); });
}

std::string Hdf5Reader::one_text(const std::string& path) const {
    const auto all = text_dataset(path);
    return all.empty() ? std::string() : all.front();
}

std::vector<double> Hdf5Reader::frame(const std::string& path, hsize_t index) const {
    return part<double>(path, index, 1);
}

std::size_t Hdf5Reader::part_size(const std::string& path, hsize_t count) const {
    const Hdf5Shape size = shape(dataset(path), path);
    hsize_t all = count;
    for (std::size_t k = 1; k < size.size(); ++k) all *= size[k];
    return all;
}

void Hdf5Reader::read_part(const std::string& path, hsize_t start, hsize_t count, hid_t type, void* values) const {
    const Hdf5Handle set = dataset(path);
    Hdf5Shape block = shape(set, path);
    if (block.empty() || start + count > block[0]) fail(fmt::format("{} has too few entries", path));
    if (std::find(block.begin() + 1, block.end(), hsize_t{0}) != block.end() || count == 0) return;
    Hdf5Shape offset(block.size(), 0);
    offset[0] = start;
    block[0] = count;
    Hdf5Handle source(H5Dget_space(set), H5Sclose, at(path));
    hdf5_check(H5Sselect_hyperslab(source, H5S_SELECT_SET, offset.data(), nullptr, block.data(), nullptr), at(path));
    Hdf5Handle target(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr), H5Sclose, at(path));
    hdf5_check(H5Dread(set, type, target, source, H5P_DEFAULT, values), at(path));
}

std::string Hdf5Reader::at(const std::string& object) const {
    return fmt::format("{}: {}", failure_, object);
}

Hdf5Handle Hdf5Reader::opened(const fs::path& path) const {
    std::error_code error;
    if (!fs::exists(path, error)) fail("there is no such file");
    if (fs::is_directory(path, error)) fail("it is a folder, a packing or run is one HDF5 file");
    if (::access(path.c_str(), R_OK) != 0) fail("no permission to read it");
    if (H5Fis_hdf5(path.c_str()) <= 0) fail("it is not an HDF5 file, or only the beginning of one");
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failure_);
    hdf5_check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), failure_);
    hdf5_check(H5Pset_file_locking(access, false, true), failure_);  // many may read one file, also on NFS
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
    if (file < 0 && reason().find("truncated") != std::string::npos)
        fail("the file is cut short: copy it again or repeat the command that wrote it");
    return {file, H5Fclose, failure_};
}

hsize_t Hdf5Reader::array_size(hid_t dataset, const std::string& path) const {
    const Hdf5Shape size = shape(dataset, path);
    if (size.size() != 1) fail(fmt::format("{} is not a one-dimensional array", path));
    Hdf5Handle type(H5Dget_type(dataset), H5Tclose, at(path));
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM)
        fail(fmt::format("{} does not hold numbers", path));
    return size[0];
}

std::optional<Hdf5Handle> Hdf5Reader::open_attribute(const std::string& object, const char* name) const {
    if (!exists(object) || H5Aexists_by_name(file_, object.c_str(), name, H5P_DEFAULT) <= 0) return std::nullopt;
    return Hdf5Handle(H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, at(object));
}

}  // namespace tomodem
