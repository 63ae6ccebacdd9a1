#include "tools/render/projection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace tomodem::render {

Eigen::Vector2d Projection::pixel(const Vec3& place) const {
    const Vec3 offset = place - focal_point;
    return {width / 2.0 + offset.dot(right) / mm_per_pixel, height / 2.0 + offset.dot(up) / mm_per_pixel};
}

Projection projection(const Picture& picture) {
    Projection result;
    result.width = picture.width;
    result.height = picture.height;
    result.towards_camera = picture.view.towards_camera.normalized();
    const Vec3 upwards = std::abs(result.towards_camera.z()) > 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
    result.right = upwards.cross(result.towards_camera).normalized();
    result.up = result.towards_camera.cross(result.right);

    const Vec3 centre = (picture.view.low + picture.view.high) / 2;
    const Vec3 half = (picture.view.high - picture.view.low) / 2;
    double half_width = result.right.cwiseAbs().dot(half), half_height = result.up.cwiseAbs().dot(half);
    if (picture.view.turning) {
        half_width = std::hypot(half.x(), half.y());
        half_height = std::abs(result.up.z()) * half.z() + std::hypot(result.up.x(), result.up.y()) * half_width;
    }
    const double side = 0.03 * picture.width, top = 0.13 * picture.height, bottom = 0.13 * picture.height;
    result.mm_per_pixel =
        std::max(2 * half_width / (picture.width - 2 * side), 2 * half_height / (picture.height - top - bottom));
    result.focal_point = centre + result.up * (top - bottom) / 2 * result.mm_per_pixel;
    result.depth = half.norm() + std::abs(top - bottom) * result.mm_per_pixel;
    return result;
}

}  // namespace tomodem::render
