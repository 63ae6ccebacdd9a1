#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"
#include "tools/metrics/fields/space_average.hpp"

namespace tomodem::fields {

/// How the neighbourhood of each particle deformed since a reference, and what in it no uniform deformation explains.
///
/// All arrays have one entry a particle; not a number where the neighbourhood is degenerate.
struct LocalStrain {
    std::vector<Symmetric> small;        ///< symmetric part of F - 1 [-], xx yy zz xy xz yz: eq. 8.13 of the thesis
    std::vector<Symmetric> logarithmic;  ///< 1/2 ln(F F^T) [-]: true strain, none in a rotation, in the present axes
    std::vector<double> equivalent;      ///< sqrt(2/3 e:e), e the deviator of the logarithmic strain [-]
    std::vector<double> volumetric;      ///< ln det F [-]
    /// Mean over the neighbours of |l - F l_ref|^2, over a length squared [-].
    std::vector<double> non_affine;
    std::int64_t degenerate = 0;  ///< particles without a strain
};

/// F = X Y^-1, X = Sum l l_ref^T, Y = Sum l_ref l_ref^T over the neighbours within a radius in the reference: the
/// uniform deformation that comes nearest to what the neighbours did.
///
/// A uniform deformation, rotation included, is found exactly, and has no non-affine part. A neighbourhood is
/// degenerate with fewer than 4 neighbours, where it is flat (the smallest eigenvalue of Y below a hundredth of the
/// largest), or turned inside out (det F <= 0).
///
/// @param reference, reference_box  points of the reference and their box; a neighbour may be a periodic image, which
///                                  moves with the edges of the box
/// @param radius  mm, more than 0, at most half of a periodic edge
/// @param length  mm, what non-affine displacements are measured in: the particles' diameter
/// @param species if given, only neighbours of the same label count
/// @throws InvalidInput as CellGrid
/// @see   Falk & Langer, Phys. Rev. E 57 (1998) 7192, eq. 2.11-2.14 (their D^2_min is the sum, this the mean)
LocalStrain local_strain(std::span<const Vec3> reference, const Box& reference_box, std::span<const Vec3> present,
                         const Box& present_box, double radius, double length,
                         std::span<const std::int32_t> species = {}, int threads = 1);

}  // namespace tomodem::fields
