#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/packing.hpp"

namespace tomodem {

/// Second moments (Mxx, Myy, Mzz) [mm^2] of the points `members` about their mean, divided by their number.
Vec3 second_moments(std::span<const Vec3> centres, std::span<const std::size_t> members);

/// S_f = H / D of the ellipsoid that has these second moments; along z, sqrt(Mzz) / ((sqrt(Mxx) + sqrt(Myy)) / 2).
///
/// H is the height along the load axis (0, 1, 2 for x, y, z) and D the mean of the two widths across it, in the axes of
/// the sample: an ellipsoid that lies askew is not turned.
/// @see method.md, "Reconstruction and measures"; thesis section 12.3
double shape_factor(const Vec3& second_moments, int axis = 2);

/// One object of a sample and its particles.
struct Object {
    std::int32_t number, species;
    std::vector<std::size_t> members;  ///< indices into the packing
};

struct ObjectChoice {
    std::size_t min_particles = 20;  ///< at least 4
    bool exclude_boundary = false;
};

struct ChosenObjects {
    std::vector<Object> used;     ///< by number
    std::size_t too_small = 0;    ///< fewer particles than asked for, or all of them in one plane
    std::size_t at_boundary = 0;  ///< of those large enough
};

/// Objects (number > 0) that have a shape to measure.
///
/// An object is at the boundary if one of its centres is less than a particle diameter from a face of the box that was
/// filled, or from the smallest box around all centres (a relaxed sample is not exactly the box that was filled).
/// @throws InvalidInput if the packing has no objects, or none is left
ChosenObjects choose_objects(const Packing& packing, const ObjectChoice& choice);

/// Mean and standard deviation over objects.
struct Spread {
    double mean = 0.0;
    std::optional<double> deviation;  ///< none for one object
};
/// Every object counts the same; deviation with n - 1.
Spread plain_spread(std::span<const double> values);
/// An object counts by its weight: deviation^2 = sum w (x - mean)^2 / sum w.
Spread weighted_spread(std::span<const double> values, std::span<const double> weights);

}  // namespace tomodem
