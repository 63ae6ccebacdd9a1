#pragma once
#include <cstdint>
#include <vector>

#include "core/surface/alpha_cells.hpp"
#include "core/surface/alpha_surface.hpp"

/// Measures of the parts of an alpha shape and of its pores.
namespace tomodem::alpha {

/// Void parts: empty cells connected through facets or edges. The solid is connected through facets alone, so neither
/// passes where the other does, and each shell of the mesh is the outside of one part of the solid or of one void.
struct Voids {
    DisjointSets sets{1};
    bool outside(std::int32_t part) { return sets.root(part) == sets.root(0); }
};

/// The void part of the empty cell beyond a facet.
inline std::int32_t void_beyond(const Facet& facet) {
    return facet.cell->neighbor(facet.opposite)->info().first_facet;
}

/// Numbers the void parts in the empty cells, and marks the centres at a void.
/// @param across  of opposite_half_edges
Voids number_voids(Delaunay& delaunay, const std::vector<Facet>& facets, const std::vector<std::int32_t>& across);

/// Bodies, centres' bodies, shares and depths of `surface`; renumbers the components in the cells by falling volume.
/// @param volumes  of the components
void measure_bodies(Delaunay& delaunay, const std::vector<double>& volumes, const AlphaSurfaceOptions& options,
                    AlphaSurface& surface);

/// Pores of `surface` without their areas and shells.
/// @return  the pore of each void part; -1: outside
std::vector<std::int32_t> measure_pores(Delaunay& delaunay, Voids& voids, AlphaSurface& surface);

/// Shells, genus and area of every body and pore, from the mesh before its parallel edges are separated.
void measure_shells(const std::vector<Facet>& facets, const std::vector<std::int32_t>& across, AlphaSurface& surface);

}  // namespace tomodem::alpha
