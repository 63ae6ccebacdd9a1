#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/volume/volume_source.hpp"

namespace tomodem {

/// All that is known of a volume format. Each stands in one source, core/volume/formats/NAME.cpp, which registers it:
///
///     const RegisteredFormat nrrd{{.name = "NRRD", .extensions = {".nrrd", ".nhdr"}, .sniff = ..., .open = ...}};
///
/// From what is registered follow the reading, the files that a digest covers, the volumes that are found in a folder,
/// and the formats that help texts and error lines list.
struct VolumeFormat {
    using Path = std::filesystem::path;

    std::string name;  ///< as texts list it
    /// Of the files that are a volume, as ".nrrd", in lower case.
    std::vector<std::string> extensions;
    /// Whether a file is of this format by its first 64 bytes (fewer if it is shorter) or its name. A file that no
    /// format recognises so is opened by the one that has its extension. None: the extension decides.
    std::function<bool(const std::string& start, const Path& file)> sniff = {};
    /// The files that the volume of a file is made of, as far as its header can be read, in an order that stays; some
    /// may be missing. None: the file alone.
    std::function<std::vector<Path>(const Path& file)> companions = {};
    /// @param dataset  text behind the colon of FILE:DATASET; empty where there is none
    /// @throws InvalidInput with one line, whatever the file holds
    std::function<std::unique_ptr<VolumeSource>(const Path& file, const std::string& dataset)> open;
    bool has_datasets = false;  ///< FILE:DATASET is read
    /// Opens a series of files with one slice each, in this order; none: a slice is no file of this format.
    /// @param series  name of the whole, for messages
    std::function<std::unique_ptr<VolumeSource>(std::vector<Path> slices, const std::string& series)> open_slices = {};
};

/// Makes a format known, as a constant of namespace scope.
class RegisteredFormat {
 public:
    explicit RegisteredFormat(VolumeFormat format);
};

/// Every registered format, by name.
const std::vector<VolumeFormat>& volume_formats();

/// The names of all formats between commas.
std::string volume_format_names();

}  // namespace tomodem
