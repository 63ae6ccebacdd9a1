#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "core/packing/packing.hpp"

namespace tomodem {

struct AlphaSurfaceOptions {
    double probe_radius =
        0.0;  ///< mm, more than 0: what a ball of this radius between the centres cannot enter is filled
    /// Called now and then with the fraction done, 0 to 1, from the calling thread.
    std::function<void(double)> progress = {};
    /// mm; of equal particles, for the corrected volumes; 0: those of the pores are not known.
    double seed_radius = 0.0;
    std::size_t auxiliary =
        0;  ///< number of centres at the end that shape the surface like the others, but are no particles
};

/// A part of the solid (filled tetrahedra connected through facets), or a pore (empty ones connected through facets or
/// edges, from which no such way leads out).
struct Body {
    double volume = 0.0;         ///< mm^3, of its tetrahedra
    double area = 0.0;           ///< mm^2, of all its surfaces
    Vec3 centre = Vec3::Zero();  ///< mm, of its volume
    std::int64_t particles = 0;  ///< centres in or touching it, each in one part only; of a pore: around it
    std::int64_t shells = 0;     ///< closed surfaces: the outer one and one around each hole (pore: each island)
    std::int64_t genus = 0;      ///< of all its surfaces together: the number of handles, b1
    /// Volume up to where the material ends (docs/measures.md); not a number where it cannot be measured.
    double corrected_volume = std::numeric_limits<double>::quiet_NaN();

    /// Of its surfaces, 2 (shells - genus); that of the body itself is half of it.
    std::int64_t euler_characteristic() const { return 2 * (shells - genus); }
};

inline constexpr std::int32_t deepest_centre = 4;

/// Alpha shape of a set of points: its surface and its measures.
struct AlphaSurface {
    TriangleMesh mesh;               ///< outward oriented; voids inside have surfaces of their own
    double volume = 0.0;             ///< mm^3, sum of the filled tetrahedra
    double area = 0.0;               ///< mm^2, voids inside included
    std::vector<double> components;  ///< volume [mm^3] of each part connected through facets, largest first

    std::vector<Body> bodies;  ///< the parts, largest first
    std::vector<Body> pores;   ///< largest first
    std::vector<std::int32_t> body_of_triangle;
    std::vector<std::int32_t> pore_of_triangle;  ///< the pore beyond it; -1: the outside
    std::vector<std::int32_t> centre_of_vertex;  ///< -1: the middle of an edge
    std::vector<std::int32_t>
        body_of_centre;  ///< the largest part that it belongs to or touches; -1: none, or a duplicate
    std::vector<std::vector<std::int32_t>> centres_of_pore;  ///< around each pore, increasing
    double inside_volume = 0.0;  ///< mm^3 a particle that lies within the matter, mean; 0: none does
    std::vector<bool> outside;   ///< is the centre at the void outside?
    std::vector<double> share;   ///< mm^3 of each centre: a quarter of each filled tetrahedron around it
    /// Edges from each centre to the nearest one at a void, at most deepest_centre: near a void shares are too small.
    std::vector<std::int8_t> depth;
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

/// The surfaces of some parts or pores alone, their points numbered anew.
struct SurfacePart {
    TriangleMesh mesh;
    std::vector<std::int32_t> number;  ///< of each triangle: its body or pore, from 0
};
/// Triangles whose number is not negative.
SurfacePart surface_part(const TriangleMesh& mesh, const std::vector<std::int32_t>& number);
SurfacePart body_surface(const AlphaSurface& surface);
/// Oriented out of the pores, so that their volume is positive.
SurfacePart pore_surface(const AlphaSurface& surface);

/// Moves every point of a surface along its normal, each body by one distance, until the volume it encloses is the
/// corrected one. Bodies without a corrected volume stay. Narrow dents may cross themselves.
void correct_envelope(SurfacePart& part, const std::vector<Body>& bodies);

}  // namespace tomodem
