#pragma once
#include <filesystem>
#include <string>

namespace tomodem::plan {

/// @throws InvalidInput if it cannot be read
std::string read_text(const std::filesystem::path& path);

/// Writes the text atomically; a file that holds it already keeps its date.
void write_if_changed(const std::filesystem::path& path, const std::string& text);

}  // namespace tomodem::plan
