#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/volume/grey_volume.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {

using Colour = std::array<std::uint8_t, 3>;

/// A picture on a page and the line above it.
struct Panel {
    std::string caption;
    int width = 0, height = 0;    ///< in points
    double stretch = 1;           ///< height of a point over its width
    std::vector<Colour> colours;  ///< row by row, the first at the top
};

/// The middle slice across an axis (0: x, 1: y, 2: z): rows are y, for z, and z for the others.
Panel slice_panel(const LabelVolume& volume, int axis, const std::string& caption,
                  const std::function<Colour(std::int32_t label)>& colour);
/// @param window  grey values that are drawn black and white
Panel slice_panel(const GreyVolume& volume, int axis, const std::string& caption, const std::array<double, 2>& window);

/// Grey values between which all but the darkest and brightest 0.5 % lie.
std::array<double, 2> grey_window(const GreyVolume& volume);

/// How often each grey value occurs, between the ends of a window; heights are square roots, so that small peaks show.
Panel histogram_panel(const GreyVolume& volume, const std::string& caption, const std::array<double, 2>& window);

/// A colour for each number from 1 on, far from those of the numbers beside it.
Colour colour_of_object(std::int32_t number);

/// Draws panels in rows on a white page, each row at its scale, as a PNG (atomically).
/// @throws InvalidInput if it cannot be written
void write_panels(const std::vector<std::vector<Panel>>& rows, const std::filesystem::path& picture);

}  // namespace tomodem
