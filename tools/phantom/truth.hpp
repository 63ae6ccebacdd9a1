#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/provenance.hpp"
#include "core/volume/volume.hpp"
#include "tools/phantom/spheres.hpp"

namespace tomodem::phantom {

/// The truth of a phantom: how it was made, size, voxel size, and of each label the voxels and their fraction.
/// @param names      name of each label
/// @param fractions  analytic fraction of each label, where it is known
nlohmann::ordered_json truth_of(const LabelVolume& volume, const Provenance& provenance, std::int64_t random_seed,
                                const std::map<std::int32_t, std::string>& names,
                                const std::map<std::int32_t, double>& fractions);

/// Centre, radius (of the sphere of equal volume), volume and spheres of each grain, in mm and in voxels.
nlohmann::ordered_json grains_truth(const std::vector<Grain>& grains, const std::vector<std::int64_t>& voxels,
                                    std::int32_t label, double voxel_size);

/// "phantom.tif" -> "phantom.json", unless the user named another file.
std::filesystem::path truth_path(const std::filesystem::path& volume, const std::filesystem::path& wanted);

/// Reports the fractions, writes the truth and then the volume.
void write_phantom(const LabelVolume& volume, const std::filesystem::path& path, const nlohmann::ordered_json& truth,
                   const std::filesystem::path& truth_path, Reporter& reporter);

}  // namespace tomodem::phantom
