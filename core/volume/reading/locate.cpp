#include "core/volume/reading/locate.hpp"

#include <glob.h>

#include <algorithm>
#include <memory>

#include "core/volume/reading/reading.hpp"

namespace tomodem::formats {
namespace {

bool has_extension_of(const VolumeFormat& format, const fs::path& file) {
    const std::string extension = lower_case(file.extension().string());
    return std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end();
}

bool may_be_slice(const fs::path& file) {
    return !file.filename().string().starts_with('.') &&
           std::any_of(volume_formats().begin(), volume_formats().end(), [&](const VolumeFormat& format) {
               return format.open_slices && has_extension_of(format, file);
           });
}

/// FILE:DATASET in two parts; the second is empty where there is none.
std::pair<std::string, std::string> split_dataset(const std::string& spec) {
    std::error_code error;
    for (std::size_t colon = spec.find(':'); colon != std::string::npos; colon = spec.find(':', colon + 1))
        if (fs::is_regular_file(spec.substr(0, colon), error)) return {spec.substr(0, colon), spec.substr(colon + 1)};
    return {spec, ""};
}

/// Files that a pattern with * ? [] names.
std::vector<fs::path> matches(const std::string& pattern) {
    glob_t found{};
    const std::unique_ptr<glob_t, decltype(&globfree)> guard(&found, &globfree);
    std::vector<fs::path> files;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
        for (std::size_t i = 0; i < found.gl_pathc; ++i)
            if (fs::is_regular_file(found.gl_pathv[i])) files.emplace_back(found.gl_pathv[i]);
    return files;
}

}  // namespace

std::vector<fs::path> slices_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
        if (may_be_slice(it->path()) && fs::is_regular_file(it->path())) files.push_back(it->path());
    if (error) cannot_read(folder, error.message());
    std::sort(files.begin(), files.end());
    return files;
}

Located locate(const std::string& spec) {
    Located found;
    std::error_code error;
    if (fs::exists(spec, error)) {
        found.is_folder = fs::is_directory(spec, error);
        found.files = found.is_folder ? slices_in(spec) : std::vector<fs::path>{spec};
        return found;
    }
    const auto [file, dataset] = split_dataset(spec);
    if (fs::is_regular_file(file, error)) {
        found.files = {file};
        found.dataset = dataset;
    } else if (spec.find_first_of("*?[") != std::string::npos) {
        found.is_pattern = true;
        found.files = matches(spec);
    }
    return found;
}

const VolumeFormat* format_of_extension(const fs::path& file) {
    const auto& formats = volume_formats();
    const auto found = std::find_if(formats.begin(), formats.end(),
                                    [&](const VolumeFormat& format) { return has_extension_of(format, file); });
    return found == formats.end() ? nullptr : &*found;
}

const VolumeFormat* format_of(const fs::path& file) {
    const std::string start = first_bytes(file, 64);
    if (start.empty()) cannot_read(file, "the file is empty");
    for (const VolumeFormat& format : volume_formats())
        if (format.sniff && format.sniff(start, file)) return &format;
    return format_of_extension(file);
}

}  // namespace tomodem::formats
