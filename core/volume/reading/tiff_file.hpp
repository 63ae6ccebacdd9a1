#pragma once
#include <tiffio.h>

#include <cstdarg>
#include <filesystem>
#include <string>

namespace tomodem::formats {

/// Whether a file that starts like this is a TIFF or a BigTIFF.
bool is_tiff(const std::string& first_bytes);

/// An open TIFF. What libtiff has to say is kept for our own message instead of being printed.
class TiffFile {
 public:
    TiffFile(const std::filesystem::path& path, const char* mode);
    ~TiffFile() { close(); }
    TiffFile(const TiffFile&) = delete;
    TiffFile& operator=(const TiffFile&) = delete;

    explicit operator bool() const { return handle_ != nullptr; }
    TIFF* handle() const { return handle_; }
    const std::filesystem::path& path() const { return path_; }
    const std::string& error() const { return error_; }
    void close();

    template <class T>
    T tag(std::uint32_t name, T otherwise) const {
        T value{};
        return TIFFGetFieldDefaulted(handle_, name, &value) ? value : otherwise;
    }

 private:
    static int keep_first_error(TIFF*, void* self, const char*, const char* format, va_list arguments);
    static int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

    std::filesystem::path path_;
    TIFF* handle_ = nullptr;
    std::string error_;
};

}  // namespace tomodem::formats
