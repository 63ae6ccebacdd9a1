#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/volume/volume_source.hpp"

namespace tomodem {

struct VolumeOptions;

/// A grey tomography in memory, as 32-bit floats: exact for integers below 16,777,216. For filters; what only reads
/// grey values once takes GreySlabs.
struct GreyVolume {
    VoxelIndex size{};
    Vec3 spacing = Vec3::Ones();          ///< mm
    Vec3 origin = Vec3::Zero();           ///< world coordinates [mm] of the corner of voxel (0, 0, 0)
    VoxelType type = VoxelType::float32;  ///< of the file, or of the means of --bin
    std::vector<float> values;            ///< x fastest, then y, then z
    std::string description;              ///< one line: size, type and format of the file, size of the voxels

    /// What the values are written as: `type` where it has at most 16 bits, else float32.
    VoxelType stored_type() const { return bytes_of(type) <= 2 ? type : VoxelType::float32; }
    std::int64_t at(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return (std::int64_t{z} * size[1] + y) * size[0] + x;
    }
};

/// Region and blocks as read_image takes them; thresholds and new names of labels do not apply.
/// @throws InvalidInput as read_image; if a value is not a finite number, or an integer that float32 would change
/// @note   memory: 4 bytes a voxel and one slab
GreyVolume read_grey_volume(const std::string& spec, const VolumeOptions& options, int threads, Reporter& reporter);

/// Writes a multipage TIFF (atomically), LZW, of stored_type(): integers are rounded, and cut at the ends of their
/// range.
void write_grey_volume(const GreyVolume& volume, const std::filesystem::path& path, Reporter& reporter);

}  // namespace tomodem
