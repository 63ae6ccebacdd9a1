#pragma once
#include <Eigen/Core>

#include "tools/render/picture.hpp"

namespace tomodem::render {

/// Axes of the picture plane, and the scale at which the view's region fits between the margins.
struct Projection {
    Vec3 towards_camera, right, up;
    Vec3 focal_point;           ///< centre of the picture
    double mm_per_pixel = 1.0;  ///< of the final picture
    double depth = 1.0;         ///< from the focal point to the farthest corner [mm]
    int width = 0, height = 0;

    /// Pixels from the lower left corner of the picture.
    Eigen::Vector2d pixel(const Vec3& place) const;
};

Projection projection(const Picture& picture);

}  // namespace tomodem::render
