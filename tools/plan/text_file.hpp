#pragma once
#include <filesystem>
#include <string>

namespace tomodem::plan {

/// @throws InvalidInput if it cannot be read
std::string read_text(const std::filesystem::path& path);

}  // namespace tomodem::plan
