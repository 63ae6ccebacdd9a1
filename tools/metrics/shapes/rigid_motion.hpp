#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"

/// How an object moved as a whole: displacement, rotation, and what is left, its deformation.
namespace tomodem::shapes {

struct RigidMotion {
    Vec3 displacement = Vec3::Zero();  ///< of the mean of the points [mm]
    /// Angle [degrees, 0 to 180] times the unit vector of the axis, right-handed. None where the points lie on one line
    /// (or are fewer than three), as any turn about that line would do.
    std::optional<Vec3> rotation{};
    /// Root mean square distance [mm] of the points from where the rigid motion takes them; where there is a rotation.
    std::optional<double> residual{};
};

/// The rigid motion that takes the points `members` from one set of positions to another with the smallest sum of
/// squared distances.
/// @param before, after  positions [mm] of the same points in the same order
/// @param members        at least one
/// @see   Kabsch, Acta Cryst. A 32 (1976) 922 and A 34 (1978) 827 (a rotation, never a reflection)
RigidMotion rigid_motion(std::span<const Vec3> before, std::span<const Vec3> after,
                         std::span<const std::size_t> members);

}  // namespace tomodem::shapes
