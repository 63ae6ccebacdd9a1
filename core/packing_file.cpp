#include "core/packing_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "core/output_file.hpp"
#include "core/xdmf.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "positions are handed to HDF5 as rows of three numbers");

// ---- HDF5 handles -------------------------------------------------------------------------------------------------

/// HDF5 is not thread-safe in Debian's build: every public function below holds this lock.
std::unique_lock<std::recursive_mutex> hdf5() {
    static std::recursive_mutex mutex;
    std::unique_lock lock(mutex);
    static const bool silenced = [] {
        H5dont_atexit();  // what could not be written when the disk was full must not be tried again at exit
        return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
    }();
    (void)silenced;
    return lock;
}

/// What HDF5 says about its last failure: the text nearest to the cause.
std::string hdf5_reason() {
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

/// Owns one HDF5 identifier of any kind. A negative result of HDF5 becomes an error naming the file.
class Handle {
 public:
    using Close = herr_t (*)(hid_t);
    Handle(hid_t id, Close close, const std::string& failure) : id_(id), close_(close) {
        if (id < 0) throw InvalidInput(fmt::format("{}: {}", failure, hdf5_reason()));
    }
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }
    /// Closes now. @return whether HDF5 could (a file: everything is written)
    bool close() { return close_(std::exchange(id_, -1)) >= 0; }

 private:
    hid_t id_;
    Close close_;
};

void check(herr_t status, const std::string& failure) {
    if (status < 0) throw InvalidInput(fmt::format("{}: {}", failure, hdf5_reason()));
}

template <class T>
hid_t native();
template <>
hid_t native<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native<std::int32_t>() {
    return H5T_NATIVE_INT32;
}
template <>
hid_t native<std::int64_t>() {
    return H5T_NATIVE_INT64;
}

using Shape = std::vector<hsize_t>;

// ---- writing ------------------------------------------------------------------------------------------------------

/// A new HDF5 file with the few calls that an H5MD file needs. Errors name the file that the user asked for.
class Writer {
 public:
    Writer(const fs::path& where, const fs::path& shown)
        : failure_(fmt::format("cannot write '{}'", shown.string())), file_(created(where)) {}

    const std::string& failure() const { return failure_; }
    hid_t file() const { return file_; }

    Handle group(hid_t parent, const char* name) {
        const Handle creation = untimed(H5P_GROUP_CREATE);
        return {H5Gcreate2(parent, name, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, failure_};
    }
    template <class T>
    void attribute(hid_t object, const char* name, std::span<const T> values, bool scalar = false) {
        const hsize_t count = values.size();
        Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose, failure_);
        Handle attribute(H5Acreate2(object, name, native<T>(), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failure_);
        check(H5Awrite(attribute, native<T>(), values.data()), failure_);
    }
    template <class T>
    void attribute(hid_t object, const char* name, T value) {
        attribute<T>(object, name, std::span<const T>(&value, 1), true);
    }
    void attribute(hid_t object, const char* name, const std::string& text) {
        const Handle type = text_type(text.size());
        Handle space(H5Screate(H5S_SCALAR), H5Sclose, failure_);
        Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failure_);
        check(H5Awrite(attribute, type, padded({text}).data()), failure_);
    }
    void attribute(hid_t object, const char* name, const std::vector<std::string>& texts) {
        const Handle type = text_type(longest(texts));
        const hsize_t count = texts.size();
        Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, failure_);
        Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failure_);
        check(H5Awrite(attribute, type, padded(texts).data()), failure_);
    }
    template <class T>
    Handle dataset(hid_t parent, const char* name, const Shape& shape, const T* data) {
        Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, failure_);
        const Handle creation = untimed(H5P_DATASET_CREATE);
        Handle dataset(H5Dcreate2(parent, name, native<T>(), space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                       failure_);
        check(H5Dwrite(dataset, native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), failure_);
        return dataset;
    }
    /// One string, or with `list` an array of them.
    void text_dataset(hid_t parent, const char* name, const std::vector<std::string>& texts, bool list = true) {
        const Handle type = text_type(longest(texts));
        const hsize_t count = texts.size();
        Handle space(list ? H5Screate_simple(1, &count, nullptr) : H5Screate(H5S_SCALAR), H5Sclose, failure_);
        const Handle creation = untimed(H5P_DATASET_CREATE);
        Handle dataset(H5Dcreate2(parent, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose, failure_);
        if (count > 0) check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded(texts).data()), failure_);
    }
    /// An empty [0][rows][3] dataset that grows by frames.
    Handle growing_frames(hid_t parent, const char* name, hsize_t rows) {
        constexpr hsize_t rows_per_chunk = 65536;  // 1.5 MiB
        const hsize_t pieces = (rows + rows_per_chunk - 1) / rows_per_chunk;
        const hsize_t chunk[] = {1, (rows + pieces - 1) / pieces, 3};  // equal pieces: the last one is not half empty
        const hsize_t start[] = {0, rows, 3};
        const hsize_t most[] = {H5S_UNLIMITED, rows, 3};
        const Handle creation = untimed(H5P_DATASET_CREATE);
        check(H5Pset_chunk(creation, 3, chunk), failure_);
        check(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER), failure_);
        Handle space(H5Screate_simple(3, start, most), H5Sclose, failure_);
        return {H5Dcreate2(parent, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                failure_};
    }
    void append_frame(hid_t dataset, hsize_t index, std::span<const Vec3> rows) {
        const hsize_t size[] = {index + 1, rows.size(), 3};
        const hsize_t offset[] = {index, 0, 0};
        const hsize_t count[] = {1, rows.size(), 3};
        check(H5Dset_extent(dataset, size), failure_);
        Handle target(H5Dget_space(dataset), H5Sclose, failure_);
        check(H5Sselect_hyperslab(target, H5S_SELECT_SET, offset, nullptr, count, nullptr), failure_);
        Handle source(H5Screate_simple(3, count, nullptr), H5Sclose, failure_);
        check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, source, target, H5P_DEFAULT, rows.front().data()), failure_);
        check(H5Fflush(file_, H5F_SCOPE_LOCAL), failure_);
    }
    /// A [rows][3] dataset without data of its own that shows one frame of another dataset of this file.
    void frame_view(hid_t parent, const std::string& name, const char* source, hsize_t index, hsize_t frames,
                    hsize_t rows) {
        const hsize_t whole[] = {frames, rows, 3};
        const hsize_t offset[] = {index, 0, 0};
        const hsize_t count[] = {1, rows, 3};
        Handle slab(H5Screate_simple(3, whole, nullptr), H5Sclose, failure_);
        check(H5Sselect_hyperslab(slab, H5S_SELECT_SET, offset, nullptr, count, nullptr), failure_);
        Handle view(H5Screate_simple(2, count + 1, nullptr), H5Sclose, failure_);
        const Handle creation = untimed(H5P_DATASET_CREATE);
        check(H5Pset_virtual(creation, view, ".", source, slab), failure_);
        Handle dataset(H5Dcreate2(parent, name.c_str(), H5T_IEEE_F64LE, view, H5P_DEFAULT, creation, H5P_DEFAULT),
                       H5Dclose, failure_);
    }
    void close() {
        if (!file_.close()) throw InvalidInput(fmt::format("{}: {}", failure_, hdf5_reason()));
    }

 private:
    Handle created(const fs::path& where) {
        Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failure_);
        check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110), failure_);  // views need 1.10
        check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), failure_);
        check(H5Pset_file_locking(access, false, true), failure_);  // the part file is ours alone
        const Handle creation = untimed(H5P_FILE_CREATE);
        return {H5Fcreate(where.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, failure_};
    }
    /// No time stamps: the same input gives the same bytes.
    Handle untimed(hid_t property_class) {
        Handle list(H5Pcreate(property_class), H5Pclose, failure_);
        check(H5Pset_obj_track_times(list, false), failure_);
        return list;
    }
    Handle text_type(std::size_t size) {
        Handle type(H5Tcopy(H5T_C_S1), H5Tclose, failure_);
        check(H5Tset_size(type, std::max<std::size_t>(size, 1)), failure_);
        check(H5Tset_strpad(type, H5T_STR_NULLPAD), failure_);
        check(H5Tset_cset(type, H5T_CSET_UTF8), failure_);
        return type;
    }
    static std::size_t longest(const std::vector<std::string>& texts) {
        std::size_t size = 0;
        for (const std::string& text : texts) size = std::max(size, text.size());
        return size;
    }
    static std::string padded(const std::vector<std::string>& texts) {
        const std::size_t size = std::max<std::size_t>(longest(texts), 1);
        std::string all;
        for (const std::string& text : texts) (all += text).append(size - text.size(), '\0');
        return all;
    }

    std::string failure_;
    Handle file_;
};

std::string user_name() {
    const passwd* entry = ::getpwuid(::geteuid());
    return entry != nullptr && entry->pw_name[0] != '\0' ? entry->pw_name : "unknown";
}

void write_provenance(Writer& writer, const Provenance& provenance) {
    Handle parameters = writer.group(writer.file(), "parameters");
    Handle group = writer.group(parameters, "tomodem");
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
    Handle inputs = writer.group(group, "inputs");
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

// ---- reading ------------------------------------------------------------------------------------------------------

/// An existing HDF5 file, opened for reading; errors name the file and the object in it.
class Reader {
 public:
    explicit Reader(const fs::path& path)
        : failure_(fmt::format("cannot read '{}'", path.string())), file_(opened(path)) {}

    [[noreturn]] void fail(const std::string& what) const { throw InvalidInput(failure_ + ": " + what); }
    const std::string& failure() const { return failure_; }

    bool exists(const std::string& path) const {
        for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
            if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
            if (end == std::string::npos) return true;
        }
    }
    bool is_group(const std::string& path) const {
        H5O_info_t info;
        return exists(path) && H5Oget_info_by_name2(file_, path.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
               info.type == H5O_TYPE_GROUP;
    }
    std::vector<std::string> members(const std::string& path) const {
        Handle group(H5Gopen2(file_, path.c_str(), H5P_DEFAULT), H5Gclose, at(path));
        std::vector<std::string> names;
        hsize_t index = 0;
        check(H5Literate(
                  group, H5_INDEX_NAME, H5_ITER_INC, &index,
                  [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
                      static_cast<std::vector<std::string>*>(out)->push_back(name);
                      return 0;
                  },
                  &names),
              at(path));
        return names;
    }
    Handle dataset(const std::string& path) const {
        if (!exists(path)) fail(fmt::format("it has no {}: not a packing or run of tomodem", path));
        return {H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, at(path)};
    }
    Shape shape(hid_t dataset, const std::string& path) const {
        Handle space(H5Dget_space(dataset), H5Sclose, at(path));
        const int rank = H5Sget_simple_extent_ndims(space);
        if (rank < 0) fail(path + " has no shape");
        Shape shape(static_cast<std::size_t>(rank));
        H5Sget_simple_extent_dims(space, shape.data(), nullptr);
        return shape;
    }
    /// A one-dimensional array, converted to T.
    template <class T>
    std::vector<T> array(const std::string& path) const {
        const Handle set = dataset(path);
        const Shape size = shape(set, path);
        if (size.size() != 1) fail(fmt::format("{} is not a one-dimensional array", path));
        require_number(set, path);
        std::vector<T> values(size[0]);
        if (!values.empty()) check(H5Dread(set, native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), at(path));
        return values;
    }
    Vec3 vector(const std::string& path) const {
        const auto values = array<double>(path);
        if (values.size() != 3) fail(fmt::format("{} has {} values instead of 3", path, values.size()));
        return {values[0], values[1], values[2]};
    }
    template <class T>
    std::optional<T> number_attribute(const std::string& object, const char* name) const {
        const auto attribute = open_attribute(object, name);
        if (!attribute) return std::nullopt;
        Handle space(H5Aget_space(*attribute), H5Sclose, at(object));
        if (H5Sget_simple_extent_npoints(space) != 1) fail(fmt::format("{}@{} is not one number", object, name));
        T value{};
        check(H5Aread(*attribute, native<T>(), &value), at(object));
        return value;
    }
    std::vector<std::string> text_attribute(const std::string& object, const char* name) const {
        const auto attribute = open_attribute(object, name);
        if (!attribute) return {};
        Handle type(H5Aget_type(*attribute), H5Tclose, at(object));
        Handle space(H5Aget_space(*attribute), H5Sclose, at(object));
        const hid_t id = *attribute;
        return texts(type, space, at(object), [id](hid_t memory, void* out) { return H5Aread(id, memory, out); });
    }
    std::vector<std::string> text_dataset(const std::string& path) const {
        if (!exists(path)) return {};
        const Handle set = dataset(path);
        Handle type(H5Dget_type(set), H5Tclose, at(path));
        Handle space(H5Dget_space(set), H5Sclose, at(path));
        return texts(type, space, at(path),
                     [&](hid_t memory, void* out) { return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, out); });
    }
    std::string one_text(const std::string& path) const {
        const auto all = text_dataset(path);
        return all.empty() ? std::string() : all.front();
    }
    /// Row `index` of a [F][N][3] array.
    std::vector<Vec3> frame(const std::string& path, hsize_t index) const {
        const Handle set = dataset(path);
        const Shape size = shape(set, path);
        const hsize_t offset[] = {index, 0, 0};
        const hsize_t count[] = {1, size[1], 3};
        Handle source(H5Dget_space(set), H5Sclose, at(path));
        check(H5Sselect_hyperslab(source, H5S_SELECT_SET, offset, nullptr, count, nullptr), at(path));
        Handle target(H5Screate_simple(3, count, nullptr), H5Sclose, at(path));
        std::vector<Vec3> rows(size[1]);
        if (!rows.empty())
            check(H5Dread(set, H5T_NATIVE_DOUBLE, target, source, H5P_DEFAULT, rows.front().data()), at(path));
        return rows;
    }
    std::string at(const std::string& object) const { return fmt::format("{}: {}", failure_, object); }

 private:
    Handle opened(const fs::path& path) const {
        std::error_code error;
        if (!fs::exists(path, error)) fail("there is no such file");
        if (fs::is_directory(path, error)) fail("it is a folder, a packing or run is one HDF5 file");
        if (::access(path.c_str(), R_OK) != 0) fail("no permission to read it");
        if (H5Fis_hdf5(path.c_str()) <= 0) fail("it is not an HDF5 file, or only the beginning of one");
        Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failure_);
        check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), failure_);
        check(H5Pset_file_locking(access, false, true), failure_);  // many may read one file, also on NFS
        const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
        if (file < 0 && hdf5_reason().find("truncated") != std::string::npos)
            fail("the file is cut short: copy it again or repeat the command that wrote it");
        return {file, H5Fclose, failure_};
    }
    void require_number(hid_t dataset, const std::string& path) const {
        Handle type(H5Dget_type(dataset), H5Tclose, at(path));
        const H5T_class_t kind = H5Tget_class(type);
        if (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM)
            fail(fmt::format("{} does not hold numbers", path));
    }
    std::optional<Handle> open_attribute(const std::string& object, const char* name) const {
        if (!exists(object) || H5Aexists_by_name(file_, object.c_str(), name, H5P_DEFAULT) <= 0) return std::nullopt;
        return Handle(H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, at(object));
    }
    template <class Read>
    static std::vector<std::string> texts(hid_t type, hid_t space, const std::string& failure, const Read& read) {
        if (H5Tget_class(type) != H5T_STRING) throw InvalidInput(failure + " does not hold text");
        const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
        std::vector<std::string> all(count);
        if (count == 0) return all;
        if (H5Tis_variable_str(type) > 0) {
            std::vector<char*> pointers(count, nullptr);
            check(read(type, pointers.data()), failure);
            for (std::size_t i = 0; i < count; ++i)
                if (pointers[i] != nullptr) all[i] = pointers[i];
            H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data());
        } else {
            const std::size_t size = H5Tget_size(type);
            std::string buffer(count * size, '\0');
            check(read(type, buffer.data()), failure);
            for (std::size_t i = 0; i < count; ++i) {
                all[i] = buffer.substr(i * size, size);
                all[i].resize(std::min(all[i].find('\0'), all[i].size()));
            }
        }
        return all;
    }

    std::string failure_;
    Handle file_;
};

constexpr const char* positions_path = "/particles/all/position/value";

Box read_box(const Reader& reader) {
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

Provenance read_provenance(const Reader& reader) {
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

std::map<std::string, Observable> read_observables(const Reader& reader) {
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

// ---- RunReader ----------------------------------------------------------------------------------------------------

struct RunReader::State {
    explicit State(const fs::path& path) : reader(path) {}
    Reader reader;
    Packing packing;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::map<std::string, Observable> observables;
    Provenance provenance;
};

RunReader::RunReader(const fs::path& path) {
    const auto lock = hdf5();
    state_ = std::make_unique<State>(path);
    const Reader& reader = state_->reader;
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

    const Shape shape = reader.shape(reader.dataset(positions_path), positions_path);
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
    const auto lock = hdf5();
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
    const auto lock = hdf5();
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

double value_at(const Observable& curve, double time) {
    if (curve.value.empty()) throw InvalidInput("a curve without points has no value");
    const auto after = std::upper_bound(curve.time.begin(), curve.time.end(), time);
    if (after == curve.time.begin()) return curve.value.front();
    if (after == curve.time.end()) return curve.value.back();
    const auto i = static_cast<std::size_t>(after - curve.time.begin());
    const double share = (time - curve.time[i - 1]) / (curve.time[i] - curve.time[i - 1]);
    return std::lerp(curve.value[i - 1], curve.value[i], share);
}

// ---- RunWriter ----------------------------------------------------------------------------------------------------

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
    Writer writer;
    std::size_t particles;
    bool has_objects;
    std::optional<Handle> positions;
    std::vector<std::int64_t> step;
    std::vector<double> time;
    std::map<std::string, Observable> observables;
};

RunWriter::RunWriter(const Packing& packing, const fs::path& path, const Provenance& provenance) {
    const auto lock = hdf5();
    const std::string failure = fmt::format("cannot write '{}'", path.string());
    if (path.extension() == ".xdmf")
        throw InvalidInput(failure + ": name the HDF5 file (.h5), the .xdmf comes beside it");
    require_sound(packing, failure);

    state_ = std::make_unique<State>(packing, path);
    Writer& writer = state_->writer;
    {
        Handle h5md = writer.group(writer.file(), "h5md");
        const std::int32_t version[] = {1, 1};
        writer.attribute<std::int32_t>(h5md, "version", version);
        Handle author = writer.group(h5md, "author");
        writer.attribute(author, "name", user_name());
        Handle creator = writer.group(h5md, "creator");
        writer.attribute(creator, "name", "tomodem " + provenance.tool);
        writer.attribute(creator, "version", provenance.version);
    }
    write_provenance(writer, provenance);

    Handle particles = writer.group(writer.file(), "particles");
    Handle all = writer.group(particles, "all");
    writer.attribute(all, "seed_radius", packing.seed_radius);
    writer.attribute(all, "seed_radius_unit", std::string("mm"));
    writer.attribute(all, "relaxed", std::int32_t{packing.relaxed});

    Handle box = writer.group(all, "box");
    writer.attribute(box, "dimension", std::int32_t{3});
    std::vector<std::string> boundary;
    for (const bool periodic : packing.box.periodic) boundary.push_back(periodic ? "periodic" : "none");
    writer.attribute(box, "boundary", boundary);
    const Handle edges = writer.dataset(box, "edges", {3}, packing.box.edges.data());
    writer.attribute(edges, "unit", std::string("mm"));
    const Handle origin = writer.dataset(box, "origin", {3}, packing.box.origin.data());
    writer.attribute(origin, "unit", std::string("mm"));

    const hsize_t n = packing.size();
    writer.dataset(all, "species", {n}, packing.species.data());
    writer.dataset(all, "id", {n}, packing.id.data());
    if (state_->has_objects) writer.dataset(all, "object", {n}, packing.object.data());

    Handle position = writer.group(all, "position");
    state_->positions.emplace(writer.growing_frames(position, "value", n));
    writer.attribute(*state_->positions, "unit", std::string("mm"));
}

RunWriter::~RunWriter() {
    const auto lock = hdf5();
    state_.reset();
}

void RunWriter::add_frame(const Frame& frame) {
    const auto lock = hdf5();
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
    const auto lock = hdf5();
    Writer& writer = state_->writer;
    if (state_->step.empty()) throw InvalidInput(writer.failure() + ": the run has no frame");

    const auto series = [&](hid_t group, const std::vector<std::int64_t>& step, const std::vector<double>& time) {
        writer.dataset(group, "step", {step.size()}, step.data());
        const Handle times = writer.dataset(group, "time", {time.size()}, time.data());
        writer.attribute(times, "unit", std::string("s"));
    };
    {
        const Handle position(H5Gopen2(writer.file(), "/particles/all/position", H5P_DEFAULT), H5Gclose,
                              writer.failure());
        series(position, state_->step, state_->time);
    }
    if (!state_->observables.empty()) {
        const Handle group = writer.group(writer.file(), "observables");
        for (const auto& [name, curve] : state_->observables) {
            const Handle one = writer.group(group, name.c_str());
            writer.attribute(one, "unit", curve.unit);
            const Handle value = writer.dataset(one, "value", {curve.value.size()}, curve.value.data());
            writer.attribute(value, "unit", curve.unit);
            series(one, curve.step, curve.time);
        }
    }
    state_->positions.reset();
    {
        const Handle views = writer.group(writer.file(), "xdmf");
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
