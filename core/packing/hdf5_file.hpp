#pragma once
#include <hdf5.h>
#include <mpi.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/packing/packing.hpp"

/// The few calls of HDF5 that packing files need, with errors as InvalidInput. Internal to core.
namespace tomodem {

/// HDF5 is not thread-safe in Debian's build: every public function that uses what is below holds this lock.
/// The first call also silences the messages that HDF5 prints itself.
std::unique_lock<std::recursive_mutex> hdf5_lock();

/// @throws InvalidInput `failure` and HDF5's reason, if `status` is negative
void hdf5_check(herr_t status, const std::string& failure);

/// Type in memory of double, std::int32_t and std::int64_t.
template <class T>
hid_t hdf5_native();
template <>
hid_t hdf5_native<double>();
template <>
hid_t hdf5_native<std::int32_t>();
template <>
hid_t hdf5_native<std::int64_t>();

using Hdf5Shape = std::vector<hsize_t>;

/// Owns one HDF5 identifier of any kind. A negative result of HDF5 becomes an error naming the file.
class Hdf5Handle {
 public:
    using Close = herr_t (*)(hid_t);
    /// @throws InvalidInput `failure` and HDF5's reason, if `id` is negative
    Hdf5Handle(hid_t id, Close close, const std::string& failure);
    Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;
    ~Hdf5Handle();
    operator hid_t() const { return id_; }
    /// Closes now. @return whether HDF5 could (a file: everything is written)
    bool close();

 private:
    hid_t id_;
    Close close_;
};

/// A new HDF5 file with the few calls that an H5MD file needs. Errors name the file that the user asked for.
class Hdf5Writer {
 public:
    enum class Start { anew, from_existing };
    /// @param where  the file to create, or to add to
    /// @param shown  its name in errors
    Hdf5Writer(const std::filesystem::path& where, const std::filesystem::path& shown, Start start = Start::anew);

    const std::string& failure() const { return failure_; }
    hid_t file() const { return file_; }

    Hdf5Handle group(hid_t parent, const char* name);
    template <class T>
    void attribute(hid_t object, const char* name, std::span<const T> values, bool scalar = false) {
        const hsize_t count = values.size();
        Hdf5Handle space(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose, failure_);
        Hdf5Handle attribute(H5Acreate2(object, name, hdf5_native<T>(), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                             failure_);
        hdf5_check(H5Awrite(attribute, hdf5_native<T>(), values.data()), failure_);
    }
    template <class T>
    void attribute(hid_t object, const char* name, T value) {
        attribute<T>(object, name, std::span<const T>(&value, 1), true);
    }
    void attribute(hid_t object, const char* name, const std::string& text);
    void attribute(hid_t object, const char* name, const std::vector<std::string>& texts);
    template <class T>
    Hdf5Handle dataset(hid_t parent, const char* name, const Hdf5Shape& shape, const T* data) {
        Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, failure_);
        const Hdf5Handle creation = untimed(H5P_DATASET_CREATE);
        Hdf5Handle dataset(H5Dcreate2(parent, name, hdf5_native<T>(), space, H5P_DEFAULT, creation, H5P_DEFAULT),
                           H5Dclose, failure_);
        hdf5_check(H5Dwrite(dataset, hdf5_native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), failure_);
        return dataset;
    }
    /// One string, or with `list` an array of them.
    void text_dataset(hid_t parent, const char* name, const std::vector<std::string>& texts, bool list = true);
    /// A contiguous dataset whose place in the file is fixed now and whose numbers come later. Without `fill` it is not
    /// written at all yet (large fields).
    template <class T>
    Hdf5Handle reserved(hid_t parent, const char* name, const Hdf5Shape& shape, std::optional<T> fill = {}) {
        return reserved(parent, name, shape, hdf5_native<T>(), fill ? &*fill : nullptr);
    }
    /// Where there is one.
    void remove_group(const char* name);
    /// Another name of an object of this file.
    void link(const char* existing, hid_t parent, const char* name);
    /// A [rows][columns] dataset without data of its own that shows one frame of another dataset of this file.
    /// @param whole  frames, rows and columns of that dataset
    void frame_view(hid_t parent, const std::string& name, const std::string& source, hsize_t index,
                    const hsize_t (&whole)[3]);
    void close();

 private:
    Hdf5Handle opened(const std::filesystem::path& where, Start start);
    /// No time stamps: the same input gives the same bytes.
    Hdf5Handle untimed(hid_t property_class);
    Hdf5Handle text_type(std::size_t size);
    Hdf5Handle reserved(hid_t parent, const char* name, const Hdf5Shape& shape, hid_t type, const void* fill);

    std::string failure_;
    Hdf5Handle file_;
};

/// An existing HDF5 file whose reserved datasets are filled. Only numbers change: the file stays readable throughout.
class Hdf5Filler {
 public:
    /// With a communicator, its processes write the file together: opening and closing are collective.
    Hdf5Filler(const std::filesystem::path& where, const std::filesystem::path& shown,
               MPI_Comm processes = MPI_COMM_NULL);

    const std::string& failure() const { return failure_; }
    /// Writes a block of `shape` at `start`. `together`: every process calls at once, each with its own block.
    enum class Call { alone, together };
    template <class T>
    void write(const std::string& path, const Hdf5Shape& start, const Hdf5Shape& shape, const T* data, Call call) {
        write(path, start, shape, hdf5_native<T>(), data, call);
    }
    /// Hands everything to the system: what a killed process has written stays.
    void flush();
    void close();

 private:
    Hdf5Handle opened(const std::filesystem::path& where);
    void write(const std::string& path, const Hdf5Shape& start, const Hdf5Shape& shape, hid_t type, const void* data,
               Call call);

    std::string failure_;
    MPI_Comm processes_;
    Hdf5Handle file_;
    std::map<std::string, Hdf5Handle> datasets_;
};

/// An existing HDF5 file, opened for reading; errors name the file and the object in it.
class Hdf5Reader {
 public:
    explicit Hdf5Reader(const std::filesystem::path& path);

    [[noreturn]] void fail(const std::string& what) const;
    const std::string& failure() const { return failure_; }

    bool exists(const std::string& path) const;
    bool is_group(const std::string& path) const;
    /// Names in a group, sorted.
    std::vector<std::string> members(const std::string& path) const;
    Hdf5Handle dataset(const std::string& path) const;
    Hdf5Shape shape(hid_t dataset, const std::string& path) const;
    /// A one-dimensional array, converted to T.
    template <class T>
    std::vector<T> array(const std::string& path) const {
        const Hdf5Handle set = dataset(path);
        std::vector<T> values(array_size(set, path));
        if (!values.empty())
            hdf5_check(H5Dread(set, hdf5_native<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), at(path));
        return values;
    }
    /// An array of three numbers.
    Vec3 vector(const std::string& path) const;
    /// Nothing where the object has no such attribute.
    template <class T>
    std::optional<T> number_attribute(const std::string& object, const char* name) const {
        const auto attribute = open_attribute(object, name);
        if (!attribute) return std::nullopt;
        Hdf5Handle space(H5Aget_space(*attribute), H5Sclose, at(object));
        if (H5Sget_simple_extent_npoints(space) != 1) fail(object + "@" + name + " is not one number");
        T value{};
        hdf5_check(H5Aread(*attribute, hdf5_native<T>(), &value), at(object));
        return value;
    }
    /// All attributes of an object that are one number.
    std::vector<std::pair<std::string, double>> number_attributes(const std::string& object) const;
    /// Empty where there is none.
    std::vector<std::string> text_attribute(const std::string& object, const char* name) const;
    std::vector<std::string> text_dataset(const std::string& path) const;
    std::string one_text(const std::string& path) const;
    /// Frame `index` of a [F][N][K] array of doubles: N x K numbers.
    std::vector<double> frame(const std::string& path, hsize_t index) const;
    /// `count` entries of an array from `start` on, along its first dimension.
    template <class T>
    std::vector<T> part(const std::string& path, hsize_t start, hsize_t count) const {
        std::vector<T> values(part_size(path, count));
        read_part(path, start, count, hdf5_native<T>(), values.data());
        return values;
    }

 private:
    Hdf5Handle opened(const std::filesystem::path& path) const;
    /// Length of a one-dimensional array of numbers.
    hsize_t array_size(hid_t dataset, const std::string& path) const;
    std::size_t part_size(const std::string& path, hsize_t count) const;
    void read_part(const std::string& path, hsize_t start, hsize_t count, hid_t type, void* values) const;
    std::optional<Hdf5Handle> open_attribute(const std::string& object, const char* name) const;
    /// The object's name for errors.
    std::string at(const std::string& object) const;

    std::string failure_;
    Hdf5Handle file_;
};

}  // namespace tomodem
