#include "tools/render/colour_map.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::render {
namespace {

constexpr double pi = 3.14159265358979323846;

double linear_light(std::uint8_t value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double displayed(double light) {
    return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

/// Red, green and blue light; outside 0 to 1 where a screen has no such colour.
std::array<double, 3> light_of(double lightness, double a, double b) {
    const auto cube = [](double x) { return x * x * x; };
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

/// The hue is in degrees; a chroma that no screen shows is reduced to the largest that it does.
Rgb of_hue(double lightness, double chroma, double hue) {
    const double across = std::cos(hue * pi / 180), along = std::sin(hue * pi / 180);
    const auto fits = [&](double c) {
        for (const double light : light_of(lightness, c * across, c * along))
            if (light < -1e-6 || light > 1 + 1e-6) return false;
        return true;
    };
    if (!fits(chroma)) {
        double inside = 0, outside = chroma;
        for (int k = 0; k < 30; ++k) (fits((inside + outside) / 2) ? inside : outside) = (inside + outside) / 2;
        chroma = inside;
    }
    const auto light = light_of(lightness, chroma * across, chroma * along);
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(
            std::lround(255 * std::clamp(displayed(std::clamp(value, 0.0, 1.0)), 0.0, 1.0)));
    };
    return {byte(light[0]), byte(light[1]), byte(light[2])};
}

}  // namespace

Rgb colour_at(ColourMap map, double place) {
    const double t = std::clamp(place, 0.0, 1.0);
    if (map == ColourMap::sequential) return of_hue(0.28 + 0.64 * t, 0.115 + 0.04 * t, 300 - 195 * t);
    const double away = std::abs(2 * t - 1);
    return of_hue(0.95 - 0.47 * away, 0.165 * away, t < 0.5 ? 258 : 28);
}

std::array<double, 3> oklab(const Rgb& colour) {
    const double red = linear_light(colour.red), green = linear_light(colour.green), blue = linear_light(colour.blue);
    const double l = std::cbrt(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue);
    const double m = std::cbrt(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue);
    const double s = std::cbrt(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

}  // namespace tomodem::render
