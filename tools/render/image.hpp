#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace tomodem::render {

/// Red, green and blue of each pixel, row by row from the top.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
};

/// Writes a PNG (atomically). @throws InvalidInput if it cannot be written
void write_png(const Image& image, const std::filesystem::path& path);

}  // namespace tomodem::render
