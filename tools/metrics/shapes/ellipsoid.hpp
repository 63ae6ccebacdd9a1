#pragma once
#include <Eigen/Core>
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/table.hpp"
#include "core/packing/packing.hpp"

/// The ellipsoid of inertia: the shape of an object, in a run and in an image.
namespace tomodem::shapes {

using Mat3 = Eigen::Matrix3d;

/// Mean of the points `members`.
Vec3 mean_of(std::span<const Vec3> centres, std::span<const std::size_t> members);

/// Second moments [mm^2] of the points `members` about their mean, divided by their number.
///
/// Nothing is added for the size of the particles: an object is the region whose centres were taken, and centres are
/// spread over it evenly up to its edge (docs/measures.md: adding d^2/20 makes S_f worse).
Mat3 second_moments(std::span<const Vec3> centres, std::span<const std::size_t> members);

/// S_f = H / D of the ellipsoid that has these second moments; along z, sqrt(Mzz) / ((sqrt(Mxx) + sqrt(Myy)) / 2).
///
/// H is the height along the load axis (0, 1, 2 for x, y, z) and D the mean of the two widths across it, in the axes of
/// the sample: an ellipsoid that lies askew is not turned.
/// @see method.md, "Reconstruction and measures"; thesis section 12.3
double shape_factor(const Mat3& second_moments, int axis = 2);

/// The ellipsoid that has the second moments of a body, a^2 / 5 along its axes.
struct Ellipsoid {
    std::array<double, 3> semi_axis{};  ///< a >= b >= c [mm]
    std::array<Vec3, 3> direction{};  ///< of unit length; the largest component is positive, unless they follow others
    /// The axis of the first ellipsoid of a series (0, 1, 2 for a, b, c) that each of these continues.
    std::array<int, 3> follows{0, 1, 2};
};
Ellipsoid ellipsoid_of(const Mat3& second_moments);

/// H / D in the ellipsoid's own axes: the one that is nearest to the load over the mean of the others.
double own_shape_factor(const Ellipsoid& ellipsoid, int axis = 2);

/// Gives the axes the signs of the axes of the frame before that they continue. Directions decide which these are, as
/// lengths may change their order.
void follow(Ellipsoid& ellipsoid, const Ellipsoid& before);

/// Angle between two axes, which have no sign [degrees, 0 to 90].
double axis_angle(const Vec3& direction, const Vec3& other);

/// Measures of a body in every table of shapes: centre, volume, ellipsoid, shape factors.
struct Shape {
    Vec3 centre = Vec3::Zero();  ///< mm
    double volume = 0.0;         ///< mm^3
    Ellipsoid ellipsoid;
    double shape_factor = 0.0, own_shape_factor = 0.0;
};
Shape shape_of(const Vec3& centre, double volume, const Mat3& second_moments, int axis);

/// The columns of a Shape and its cells, in the same order.
std::vector<std::string> shape_columns();
void append_cells(const Shape& shape, std::vector<Table::Cell>& row);
/// Adds the same numbers to an object of JSON.
void append_json(const Shape& shape, nlohmann::ordered_json& object);

}  // namespace tomodem::shapes
