#include "core/volume/volume_files.hpp"

#include <algorithm>

#include "core/volume/reading/locate.hpp"
#include "core/volume/reading/reading.hpp"

namespace tomodem {

namespace fs = std::filesystem;
using namespace formats;

namespace {

std::vector<fs::path> files_of(const VolumeFormat* format, const fs::path& file) {
    if (!format || !format->companions) return {file};
    try {
        std::vector<fs::path> files = format->companions(file);
        std::erase_if(files, [](const fs::path& one) { return !fs::is_regular_file(one); });
        if (!files.empty()) return files;
    } catch (const InvalidInput&) {
        // Damage is named when the volume is read.
    }
    return {file};
}

struct Candidate {
    fs::path path;
    std::vector<fs::path> files;

    bool needs(const fs::path& file) const {
        return std::any_of(files.begin(), files.end(),
                           [&](const fs::path& one) { return one.lexically_normal() == file.lexically_normal(); });
    }
};

}  // namespace

std::vector<fs::path> volume_files(const std::string& spec) {
    const Located found = locate(spec);
    if (found.is_folder) return found.files.empty() ? std::vector<fs::path>{spec} : found.files;
    if (found.files.size() != 1) return found.files;
    try {
        return files_of(format_of(found.files.front()), found.files.front());
    } catch (const InvalidInput&) {
        return found.files;
    }
}

std::vector<fs::path> find_volumes(const fs::path& folder) {
    std::error_code error;
    std::vector<Candidate> candidates;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const fs::path& path = it->path();
        std::error_code ignored;
        if (path.filename().string().starts_with('.')) continue;
        if (fs::is_directory(path, ignored)) {
            if (!slices_in(path).empty()) candidates.push_back({path, {}});
        } else if (const VolumeFormat* format = format_of_extension(path); format && fs::is_regular_file(path)) {
            candidates.push_back({path, files_of(format, path)});
        }
    }
    if (error) cannot_read(folder, error.message());
    std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
    std::vector<fs::path> volumes;
    for (const Candidate& one : candidates) {
        const bool belongs_to_another = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
            return &other != &one && other.needs(one.path) && (!one.needs(other.path) || other.path < one.path);
        });
        if (!belongs_to_another) volumes.push_back(one.path);
    }
    return volumes;
}

}  // namespace tomodem
