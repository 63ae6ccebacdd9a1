#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "tools/render/picture.hpp"

namespace tomodem::render {

/// Draws one picture, or several in the order given, with one window.
struct Series {
    std::filesystem::path output;      ///< NAME.png or NAME.mp4
    std::vector<std::string> endings;  ///< of the pictures' names; empty: one picture, which has the name of the output
    double pictures_per_second = 12.0;  ///< of a movie
};

/// Several pictures become one movie, or NAME_0000.png and so on, each with its ending.
/// @param picture  called with each place in the series; all of one size
/// @throws InvalidInput if a file cannot be written, or there is no ffmpeg for a movie
void draw_series(const Series& series, const std::function<Picture(std::size_t)>& picture, int threads,
                 Reporter& reporter);

/// The view turned around z by a share of a whole turn, at a scale that is the same from every side.
View turned(View view, double share);

}  // namespace tomodem::render
