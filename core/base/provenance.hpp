#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tomodem {

/// What is needed to repeat a file; stored under /parameters/tomodem of every HDF5 file.
struct Provenance {
    std::string tool;
    std::string version;
    std::string command_line;
    std::string scene;                          ///< text of the scene file, empty where there was none
    std::map<std::string, std::string> inputs;  ///< file name -> SHA-256 of its content
    std::optional<double> strain_before{};      ///< of a run that continues another: true strain at its beginning
    std::optional<double> time_before{};        ///< and how long the sample was under load until then [s]
    std::string geometric_error{};              ///< of a sample against its image (JSON, from vol2pack), or empty
};

/// SHA-256 of a file, or of the sorted names and contents of the regular files of a folder, in hexadecimal.
/// @throws InvalidInput if it cannot be read
std::string content_digest(const std::filesystem::path& path);

/// The same for several files that are one input: one file's own digest, or that of their names and contents.
std::string content_digest(const std::vector<std::filesystem::path>& files);

}  // namespace tomodem
