#pragma once
#include <functional>
#include <span>

#include "core/packing/packing.hpp"
#include "core/surface/envelope.hpp"
#include "tools/relax/pores.hpp"

/// How large a pore between particles is, measured twice: docs/relaxation.md.
namespace tomodem::relax {

/// The void of a pore: where a point belongs to it and not to the outside, or to another pore.
using Belongs = std::function<bool(const Vec3&)>;

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
/// less envelope_bias() times its area.
///
/// @param centres  those within 3 diameters of the image's pore at least
PoreMeasure measure_pore(std::span<const Vec3> centres, const DistanceField& image, const Belongs& belongs,
                         const Matter& matter);

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
                         const Matter& matter, double across);

/// Distance of the grid's void from the edge of the material [mm], calibrated as envelope_bias().
/// @param across  diameter of the sphere of the pore's volume, in particles
double grid_bias(const Matter& matter, double across);

}  // namespace tomodem::relax
