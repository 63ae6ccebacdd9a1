#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

#include "core/packing/packing.hpp"

namespace tomodem {

/// Voxel counts along x, y, z; x is the column of a slice (fastest), y its row (top row first), z the slice number.
using VoxelIndex = std::array<std::int32_t, 3>;

/// How one voxel is handed on: whole bytes in this machine's order. (Values of 1, 2 or 4 bits arrive as 8.)
enum class VoxelType { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };

std::size_t bytes_of(VoxelType type);
const char* name_of(VoxelType type);  ///< "uint8", "float32" ...
bool is_float(VoxelType type);

/// The type that people write as "uint8", "u8", "float32" or "float". Empty if there is none.
std::optional<VoxelType> voxel_type(const std::string& name);

/// Calls visit(T{}) with T the C++ type of `type`.
template <class Visit>
decltype(auto) with_type(VoxelType type, const Visit& visit) {
    switch (type) {
        case VoxelType::uint8:
            return visit(std::uint8_t{});
        case VoxelType::int8:
            return visit(std::int8_t{});
        case VoxelType::uint16:
            return visit(std::uint16_t{});
        case VoxelType::int16:
            return visit(std::int16_t{});
        case VoxelType::uint32:
            return visit(std::uint32_t{});
        case VoxelType::int32:
            return visit(std::int32_t{});
        case VoxelType::uint64:
            return visit(std::uint64_t{});
        case VoxelType::int64:
            return visit(std::int64_t{});
        case VoxelType::float32:
            return visit(float{});
        case VoxelType::float64:
            break;
    }
    return visit(double{});
}

/// What a file says of the volume in it, whatever its format.
struct VolumeHeader {
    std::string format;  ///< "TIFF", "ESRF volume" ...
    VoxelIndex size{};
    VoxelType type = VoxelType::uint8;
    /// Edges of a voxel: in mm, or where the format has no unit, in relation to each other only.
    std::optional<Vec3> spacing;
    bool spacing_has_unit = false;
    std::optional<Vec3> origin;  ///< world coordinates of the corner of the first voxel [mm]
};

/// The part of every slice that is wanted, in voxels.
struct Window {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
};

/// A volume in files, read slab by slab: what every format is to the tools.
class VolumeSource {
 public:
    virtual ~VolumeSource() = default;
    VolumeSource(const VolumeSource&) = delete;
    VolumeSource& operator=(const VolumeSource&) = delete;

    const VolumeHeader& header() const { return header_; }

    /// Threads that read() may use from now on; 1 at first.
    virtual void use_threads(int threads) { threads_ = threads; }

    /// Copies the window of the `count` slices from k on, slice after slice, row after row.
    /// @param voxels  count * window.width * window.height values of header().type
    /// @throws InvalidInput if the file is cut or damaged there, naming the first slice that is
    /// @note   fastest with rising k; works on several threads (use_threads) where the format allows
    virtual void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) = 0;

 protected:
    VolumeSource() = default;
    VolumeHeader header_;
    int threads_ = 1;
};

/// Raw voxels without any header: all that the user has to say.
struct RawLayout {
    VoxelIndex size{};
    VoxelType type = VoxelType::uint8;
    bool big_endian = false;
    std::int64_t offset = 0;  ///< bytes before the first voxel
};

/// Opens a volume by what its name and first bytes say: docs/volumes.md lists the formats.
///
/// @param spec  a file; a folder of numbered slices; a pattern ("scan/img_*.tif"); FILE.h5:/path/of/dataset
/// @param raw   given: the file is raw voxels
/// @throws InvalidInput: not there, of no known format, cut, damaged
std::unique_ptr<VolumeSource> open_volume(const std::string& spec, const std::optional<RawLayout>& raw = {});

}  // namespace tomodem
