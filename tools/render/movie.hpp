#pragma once
#include <filesystem>
#include <memory>

#include "tools/render/image.hpp"

namespace tomodem::render {

/// An MP4 (H.264, plays everywhere), encoded by the program ffmpeg while the pictures are drawn.
///
/// The file appears at commit(), complete. The same pictures give the same file.
class Movie {
 public:
    /// @throws InvalidInput if there is no ffmpeg, or the file cannot be written
    Movie(const std::filesystem::path& path, int width, int height, double pictures_per_second);
    ~Movie();
    Movie(const Movie&) = delete;
    Movie& operator=(const Movie&) = delete;

    /// @throws InvalidInput with ffmpeg's complaint
    void add(const Image& image);
    void commit();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem::render
