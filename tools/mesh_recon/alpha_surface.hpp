#pragma once
#include <functional>
#include <span>
#include <vector>

#include "core/mesh.hpp"
#include "core/packing.hpp"

namespace tomodem {

struct AlphaSurfaceOptions {
    double probe_radius =
        0.0;  ///< mm, more than 0: what a ball of this radius between the centres cannot enter is filled
    /// Called now and then with the fraction done, 0 to 1, from the calling thread.
    std::function<void(double)> progress = {};
};

/// Alpha shape of a set of points: its surface and its measures.
struct AlphaSurface {
    TriangleMesh mesh;               ///< outward oriented; voids inside have surfaces of their own
    double volume = 0.0;             ///< mm^3, sum of the filled tetrahedra
    double area = 0.0;               ///< mm^2, voids inside included
    std::vector<double> components;  ///< volume [mm^3] of each part connected through facets, largest first
};

/// Probe radius that fills the gaps of a dense packing and enters every void that a particle could stand in: one
/// diameter.
///
/// A particle fits where every centre is a diameter away, which is where this probe fits. In random packings of 20,000
/// spheres at D = 0.64, 0.70 and 0.74 it leaves no void; 0.9 diameters leave one at D = 0.64, 0.85 more than
/// twenty (docs/measures.md).
inline double default_probe_radius(double seed_radius) {
    return 2.0 * seed_radius;
}

/// The envelope of particle centres that a ball of the probe radius cannot enter.
///
/// The Delaunay tetrahedra whose circumradius is at most the probe radius are filled; the surface is made of the facets
/// between filled and empty ones. For one alpha = probe_radius^2 these are the interior cells of CGAL's Alpha_shape_3,
/// without the sorted list of all alphas. Facets, edges and points that belong to no filled tetrahedron are left out.
/// Where floating point cannot tell on which side of the probe radius a tetrahedron is, it is decided exactly.
///
/// The mesh is a closed 2-manifold by its indices: every edge is in exactly two triangles and every vertex has one fan.
/// Where the solid touches itself in a vertex or an edge, vertices of equal coordinates stand for the sheets. A format
/// without indices (STL) merges them again: there an even number of triangles meets in such an edge.
///
/// @param centres  points [mm], any order; the result does not depend on duplicates
/// @throws InvalidInput if the points are fewer than four or in one plane, a coordinate is not finite, the probe radius
///                      is not positive, or no tetrahedron is filled
/// @note   O(N log N) time for a packing; about 600 bytes a particle
/// @see    Edelsbrunner & Muecke, Three-dimensional alpha shapes, ACM Trans. Graph. 13 (1994) 43
AlphaSurface alpha_surface(std::span<const Vec3> centres, const AlphaSurfaceOptions& options);

}  // namespace tomodem
