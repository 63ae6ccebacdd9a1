#pragma once
#include <array>
#include <cstdint>

namespace tomodem::render {

struct Rgb {
    std::uint8_t red = 0, green = 0, blue = 0;
};

/// Colours of a scale that goes from 0 to 1, evenly spaced to the eye.
enum class ColourMap {
    sequential,  ///< dark violet, green, light yellow: lightness grows evenly, so it also reads in grey
    diverging    ///< blue, light grey in the middle, red: for values around zero
};

/// Between the ends; 0 or 1 beyond them.
Rgb colour_at(ColourMap map, double place);

/// Lightness, and the two axes from green to red and from blue to yellow, in which equal distances look equal.
/// @see B. Ottosson, A perceptual color space for image processing (2020)
std::array<double, 3> oklab(const Rgb& colour);

}  // namespace tomodem::render
