#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/surface/envelope.hpp"
#include "tools/relax/pores.hpp"

/// How large a pore between particles is, measured twice: docs/relaxation.md.
namespace tomodem::relax {

/// The void of a pore: where a point belongs to it and not to the outside, or to another pore.
using Belongs = std::function<bool(const Vec3&)>;

/// Planes at the end of the material, in which a pore that a face cuts is made whole by its mirror image.
struct Mirrors {
    std::array<int, 3> side{0, 0, 0};  ///< of the material, along each axis: -1 its low end, 1 its high end, 0 no plane
    Vec3 plane = Vec3::Zero();         ///< where it ends [mm]

    double copies() const;               ///< 2, 4 or 8 with the mirror images; 1 without a plane
    Vec3 fold(const Vec3& point) const;  ///< into the material
    /// Part of a cube around a point on the material's side.
    double share(const Vec3& point, double edge) const;
    /// The centres and their mirror images, these off by a thousandth of a seed radius: exactly symmetrical, a
    /// triangulation has cells of no volume, whose size is noise.
    std::vector<Vec3> with_images(std::span<const Vec3> centres, double seed_radius) const;
};

/// By the alpha shape of the centres around the pore.
struct PoreMeasure {
    double volume = 0;    ///< up to where the material ends [mm^3]
    double envelope = 0;  ///< of the Delaunay tetrahedra without particles [mm^3]
    double area = 0;      ///< of their surface [mm^2]
    double distance = 0;  ///< of the surface to the image's, mean over the area, outward positive [mm]
    double spread = 0;    ///< its standard deviation [mm]
    bool leaks = false;   ///< the void goes on where it no longer belongs to the pore
};

/// Delaunay tetrahedra that a ball of one particle's diameter fits into, joined with one whose middle is in the image's
/// pore. The centres stand back from the edge of the material by some part of a particle: `volume` is the envelope's
/// less envelope_bias() times its area. With mirrors it is the measure of the pore and its images, over their number.
///
/// @param centres  those within 3 diameters of the image's pore at least
PoreMeasure measure_pore(std::span<const Vec3> centres, const DistanceField& image, const Belongs& belongs,
                         const Matter& matter, const Mirrors& mirrors = {});

/// By points of a grid, a quarter of a diameter apart: void is what balls of one diameter without a centre fill, rolled
/// back from the centres by grid_bias(), and joined with void in the image's pore.
struct PoreOverlap {
    double volume = 0;        ///< [mm^3]
    double intersection = 0;  ///< with the image's pore [mm^3]
    double united = 0;        ///< with it [mm^3]
    double image = 0;         ///< the image's pore itself, as far as it belongs [mm^3]
};
/// @param across  particles across the image's pore
PoreOverlap overlap_pore(std::span<const Vec3> centres, const DistanceField& image, const Belongs& belongs,
                         const Matter& matter, double across, const Mirrors& mirrors = {});

/// Distance of the grid's void from the edge of the material [mm], calibrated as envelope_bias().
/// @param across  diameter of the sphere of the pore's volume, in particles
double grid_bias(const Matter& matter, double across);

}  // namespace tomodem::relax
