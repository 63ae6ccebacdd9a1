#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "core/packing/packing.hpp"
#include "tools/render/colour_map.hpp"

namespace tomodem::render {

struct LegendEntry {
    Rgb colour;
    std::string text;
};

/// Which colour stands for which value.
struct ColourBar {
    ColourMap map;
    double low = 0.0, high = 1.0;
    std::string title;  ///< with the unit
    bool lower_values = false,
         higher_values = false;  ///< there are values beyond the ends; they have the colours of the ends
};

/// Direction of the parallel projection, with z up (y when looking along z).
struct View {
    Vec3 towards_camera{0.6, -1.0, 0.5};
    Vec3 low, high;        ///< region that fills the picture [mm]
    bool turning = false;  ///< the scale is such that the region fits from every side around z
};

/// Triangles of one mesh; a translucent surface is denser where it is seen at a slant.
struct Surface {
    TriangleMesh mesh;
    std::vector<Rgb> colours;  ///< one a vertex
    double opacity = 1.0;
};

struct Arrow {
    Vec3 from, to;  ///< [mm]
};

/// Everything that is drawn, in world coordinates [mm]. What is empty is left out.
struct Picture {
    int width = 1200, height = 900;  ///< pixels
    Rgb background{255, 255, 255};
    View view;

    std::vector<Vec3> centres;
    std::vector<Rgb> colours;  ///< one a sphere
    double radius = 0.0;       ///< of the spheres [mm]

    std::vector<Surface> surfaces;
    std::vector<Arrow> arrows;  ///< flat, over all else

    std::optional<Box> outline;  ///< as thin lines
    std::vector<Box> plates;     ///< thin see-through slabs

    std::vector<LegendEntry> legend;
    std::string caption;
    std::optional<ColourBar> bar;
    double arrow_key = 0.0;      ///< length [mm] of the arrow shown as a key; 0: none
    std::string arrow_key_text;  ///< what that length stands for
};

}  // namespace tomodem::render
