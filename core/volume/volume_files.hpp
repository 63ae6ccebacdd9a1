#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tomodem {

/// The existing files that a volume is made of: what its digest covers, and what must exist before a tool starts. A
/// folder without slices stands for itself.
///
/// @param spec  as of open_volume
/// @return nothing where there is no such file or folder
std::vector<std::filesystem::path> volume_files(const std::string& spec);

/// The volumes in a folder, sorted by name: files with an extension of a format, and folders with slices. Files that
/// belong to the volume of another file there (the .raw of a .mhd) and hidden ones are left out.
/// @throws InvalidInput if the folder cannot be read
std::vector<std::filesystem::path> find_volumes(const std::filesystem::path& folder);

}  // namespace tomodem
