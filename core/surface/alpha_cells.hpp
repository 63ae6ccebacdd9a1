#pragma once
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/packing/packing.hpp"

/// The tetrahedra of an alpha shape, as its parts share them; nothing outside this folder includes CGAL through it.
namespace tomodem::alpha {

struct CellInfo {
    std::int32_t component = -1;  // -1: empty
    // Filled: number of the cell's first surface facet, its others follow. Empty: number of the void part.
    std::int32_t first_facet = -1;
};

struct VertexInfo {
    std::int32_t centre = -1;
    bool at_void = false;    // not all tetrahedra around it are filled
    std::int32_t depth = 0;  // edges to the nearest point at a void, at most deepest
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<CellInfo, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<VertexInfo, Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
using Cell = Delaunay::Cell_handle;
using Vertex = Delaunay::Vertex_handle;
using Point = Kernel::Point_3;

inline bool filled(Cell cell) {
    return cell->info().component >= 0;
}

inline Vec3 vector(const Point& p) {
    return {p.x(), p.y(), p.z()};
}

inline double volume(Cell cell) {
    const Vec3 a = vector(cell->vertex(0)->point());
    return (vector(cell->vertex(1)->point()) - a)
               .cross(vector(cell->vertex(2)->point()) - a)
               .dot(vector(cell->vertex(3)->point()) - a) /
           6.0;
}

class DisjointSets {
 public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    std::size_t size() const { return parent_.size(); }
    std::int32_t root(std::int32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::int32_t i, std::int32_t j) {
        i = root(i), j = root(j);
        parent_[std::max(i, j)] = std::min(i, j);
    }

 private:
    std::vector<std::int32_t> parent_;
};

/// A facet between a filled cell and an empty one: opposite to vertex `opposite` of the filled cell.
struct Facet {
    Cell cell;
    int opposite;
    Vertex corner(int k) const {
        // CGAL's triple looks into the cell.
        return cell->vertex(Delaunay::vertex_triple_index(opposite, 2 - k));
    }
};

}  // namespace tomodem::alpha
