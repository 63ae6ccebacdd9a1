#include "core/base/provenance.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

#include "core/base/error.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

class Sha256 {
 public:
    Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
        if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
            throw std::runtime_error("OpenSSL offers no SHA-256");
    }
    void add(const void* data, std::size_t size) {
        if (EVP_DigestUpdate(context_.get(), data, size) != 1) throw std::runtime_error("OpenSSL's SHA-256 failed");
    }
    std::string hexadecimal() {
        unsigned char bytes[EVP_MAX_MD_SIZE];
        unsigned int size = 0;
        if (EVP_DigestFinal_ex(context_.get(), bytes, &size) != 1) throw std::runtime_error("OpenSSL's SHA-256 failed");
        std::string text;
        for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", bytes[i]);
        return text;
    }

 private:
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

std::string file_digest(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InvalidInput(fmt::format("cannot read '{}': it cannot be opened", path.string()));
    Sha256 digest;
    std::vector<char> buffer(std::size_t{1} << 20);
    do {
        file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        digest.add(buffer.data(), static_cast<std::size_t>(file.gcount()));
    } while (file);
    if (file.bad()) throw InvalidInput(fmt::format("cannot read '{}': reading failed part way", path.string()));
    return digest.hexadecimal();
}

std::string digest_of_all(const std::vector<fs::path>& files) {
    Sha256 digest;
    for (const fs::path& file : files) {
        const std::string name = file.filename().string();
        digest.add(name.c_str(), name.size() + 1);  // with its zero, which no name contains
        const std::string content = file_digest(file);
        digest.add(content.data(), content.size());
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
