#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/volume/volume_format.hpp"

/// From the name that a user gives a volume to its files and their format. Internal to core/volume.
namespace tomodem::formats {

/// What the name of a volume stands for.
struct Located {
    std::vector<std::filesystem::path> files;  ///< that it names, sorted; none: there is nothing of that name
    std::string dataset;                       ///< of FILE:DATASET
    bool is_folder = false, is_pattern = false;
};

/// @param spec  as of open_volume
Located locate(const std::string& spec);

/// Files of a folder that may be slices by their extension, sorted. @throws InvalidInput if it cannot be read
std::vector<std::filesystem::path> slices_in(const std::filesystem::path& folder);

/// The format that a file has by its first bytes or its extension, or nullptr. @throws InvalidInput if it cannot be
/// read
const VolumeFormat* format_of(const std::filesystem::path& file);

/// The format that has the extension of this file, or nullptr.
const VolumeFormat* format_of_extension(const std::filesystem::path& file);

}  // namespace tomodem::formats
