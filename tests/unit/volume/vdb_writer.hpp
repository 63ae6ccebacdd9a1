#pragma once
#include <filesystem>
#include <vector>

#include "core/volume/volume_source.hpp"

namespace tomodem {

/// Writes labels as an OpenVDB grid of integers with all voxels active. (OpenVDB costs 30 s a translation unit.)
void write_vdb(const std::filesystem::path& path, const VoxelIndex& size, const std::vector<std::int32_t>& labels);

}  // namespace tomodem
