#pragma once
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "core/surface/alpha_cells.hpp"

/// The surface of the filled tetrahedra as a closed manifold mesh.
namespace tomodem::alpha {

/// All facets between filled and empty cells; numbers them in the cells.
std::vector<Facet> surface_facets(const Delaunay& delaunay);

/// Half-edge h = 3 f + k runs from corner k to corner k + 1 of facet f; across[h] is the half-edge that runs back, on
/// the facet on the other side of the solid at that edge.
std::vector<std::int32_t> opposite_half_edges(const std::vector<Facet>& facets);

/// One vertex for each fan of triangles around a point.
/// @param centre_of_vertex  is filled
TriangleMesh joined_by_fans(const std::vector<Facet>& facets, const std::vector<std::int32_t>& across,
                            std::vector<std::int32_t>& centre_of_vertex);

/// Different edges may still join the same two vertices, when a sheet touches itself along an edge; each of them gets a
/// vertex of its own in its middle.
/// @return  the facet of each triangle that this adds
std::vector<std::int32_t> separate_parallel_edges(TriangleMesh& mesh, const std::vector<std::int32_t>& across);

}  // namespace tomodem::alpha
