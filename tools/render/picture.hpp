#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.hpp"
#include "core/packing.hpp"

namespace tomodem {

struct Rgb {
    std::uint8_t red = 0, green = 0, blue = 0;
};

struct LegendEntry {
    Rgb colour;
    std::string text;
};

/// From where one looks: along the parallel projection, z (or y, when looking along z) up.
struct View {
    Vec3 towards_camera{0.6, -1.0, 0.5};
    Vec3 low, high;  ///< region that fills the picture [mm]
};

/// Everything that is drawn, in world coordinates [mm]. What is empty is left out.
struct Picture {
    int width = 1200, height = 900;  ///< pixels
    Rgb background{255, 255, 255};
    View view;

    std::vector<Vec3> centres;
    std::vector<Rgb> colours;  ///< one a sphere
    double radius = 0.0;       ///< of the spheres [mm]

    TriangleMesh mesh;
    Rgb mesh_colour;

    std::optional<Box> outline;  ///< as thin lines
    std::vector<Box> plates;     ///< thin see-through slabs

    std::vector<LegendEntry> legend;
    std::string caption;
};

/// Draws with a scale bar and the directions of the axes, twice as fine as asked for and averaged, and writes a PNG
/// (atomically). The same picture on any number of threads.
/// @throws std::runtime_error if there is no software OpenGL (offscreen_window)
/// @note   20,000 spheres take about 2 s on two cores, 500,000 about 10 s
void draw(const Picture& picture, const std::filesystem::path& path);

}  // namespace tomodem
