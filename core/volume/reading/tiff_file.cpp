#include "core/volume/reading/tiff_file.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace tomodem::formats {

bool is_tiff(const std::string& first_bytes) {
    using namespace std::string_view_literals;
    const std::string_view found = std::string_view(first_bytes).substr(0, 4);
    return found == "II*\0"sv || found == "MM\0*"sv || found == "II+\0"sv || found == "MM\0+"sv;
}

TiffFile::TiffFile(const std::filesystem::path& path, const char* mode) : path_(path) {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_first_error, this);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_warning, this);
    handle_ = TIFFOpenExt(path.c_str(), mode, options);
    TIFFOpenOptionsFree(options);
}

void TiffFile::close() {
    if (handle_) TIFFClose(handle_);
    handle_ = nullptr;
}

int TiffFile::keep_first_error(TIFF*, void* self, const char*, const char* format, va_list arguments) {
    auto& error = static_cast<TiffFile*>(self)->error_;
    char text[500];
    std::vsnprintf(text, sizeof text, format, arguments);
    if (error.empty()) error = text;
    while (!error.empty() && (error.back() == '.' || error.back() == '\n')) error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    return 1;
}

}  // namespace tomodem::formats
