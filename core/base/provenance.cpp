#include "core/base/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/sha256.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

std::string file_digest(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InvalidInput(fmt::format("cannot read '{}': it cannot be opened", path.string()));
    Sha256 digest;
    std::vector<char> buffer(std::size_t{1} << 20);
    do {
        file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        digest.add(std::as_bytes(std::span(buffer).first(static_cast<std::size_t>(file.gcount()))));
    } while (file);
    if (file.bad()) throw InvalidInput(fmt::format("cannot read '{}': reading failed part way", path.string()));
    return digest.hexadecimal();
}

std::string digest_of_all(const std::vector<fs::path>& files) {
    Sha256 digest;
    for (const fs::path& file : files) {
        digest.add_all(file.filename().string() + '\0');  // which no name contains
        digest.add_all(file_digest(file));
    }
    return digest.hexadecimal();
}

}  // namespace

std::string content_digest(const fs::path& path) {
    std::error_code error;
    if (!fs::exists(path, error))
        throw InvalidInput(fmt::format("cannot read '{}': there is no such file", path.string()));
    if (!fs::is_directory(path, error)) return file_digest(path);

    std::vector<fs::path> files;
    fs::directory_iterator folder(path, error);
    if (error) throw InvalidInput(fmt::format("cannot read the folder '{}': {}", path.string(), error.message()));
    for (const fs::directory_entry& entry : folder)
        if (entry.is_regular_file(error)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return digest_of_all(files);
}

std::string content_digest(const std::vector<fs::path>& files) {
    return files.size() == 1 ? content_digest(files.front()) : digest_of_all(files);
}

}  // namespace tomodem
