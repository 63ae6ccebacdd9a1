#include "tools/mesh_recon/alpha_surface.hpp"

#include <fmt/format.h>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/spatial_sort.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/error.hpp"

namespace tomodem {
namespace {

struct CellInfo {
    std::int32_t component = -1;    // -1: empty
    std::int32_t first_facet = -1;  // number of the cell's first surface facet; its others follow
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<CellInfo, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Kernel>, CellBase>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
using Cell = Delaunay::Cell_handle;
using Vertex = Delaunay::Vertex_handle;
using Point = Kernel::Point_3;

bool filled(Cell cell) {
    return cell->info().component >= 0;
}

Vec3 vector(const Point& p) {
    return {p.x(), p.y(), p.z()};
}

double volume(Cell cell) {
    const Vec3 a = vector(cell->vertex(0)->point());
    return (vector(cell->vertex(1)->point()) - a)
               .cross(vector(cell->vertex(2)->point()) - a)
               .dot(vector(cell->vertex(3)->point()) - a) /
           6.0;
}

bool circumradius_at_most_exactly(Cell cell, double radius) {
    using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
    const auto exact = [&](int i) {
        const Point& p = cell->vertex(i)->point();
        return Exact::Point_3(p.x(), p.y(), p.z());
    };
    const CGAL::Exact_rational limit(radius);
    return CGAL::squared_radius(exact(0), exact(1), exact(2), exact(3)) <= limit * limit;
}

/// The squared circumradius is |n|^2 / (4 det^2) with n and det of the edge vectors from one vertex; both come with an
/// error of some 1e-16 of their largest terms, which decides unless the tetrahedron is flat or exactly at the limit.
bool circumradius_at_most(Cell cell, double radius) {
    const Vec3 origin = vector(cell->vertex(0)->point());
    const Vec3 a = vector(cell->vertex(1)->point()) - origin;
    const Vec3 b = vector(cell->vertex(2)->point()) - origin;
    const Vec3 c = vector(cell->vertex(3)->point()) - origin;
    const double aa = a.squaredNorm(), bb = b.squaredNorm(), cc = c.squaredNorm();
    const double determinant = a.dot(b.cross(c));
    const Vec3 numerator = aa * b.cross(c) + bb * c.cross(a) + cc * a.cross(b);
    const double left = numerator.squaredNorm();
    const double right = 4.0 * radius * radius * determinant * determinant;
    const double span = std::sqrt(std::max({aa, bb, cc}));
    const bool flat = std::abs(determinant) < 1e-5 * span * span * span;
    if (flat || std::abs(left - right) < 1e-8 * right) return circumradius_at_most_exactly(cell, radius);
    return left <= right;
}

Delaunay triangulate(std::span<const Vec3> centres, const std::function<void(double)>& progress) {
    std::vector<Point> points;
    points.reserve(centres.size());
    for (const Vec3& centre : centres) points.emplace_back(centre.x(), centre.y(), centre.z());
    // What the range insertion of CGAL does, with a progress report in the loop.
    CGAL::spatial_sort(points.begin(), points.end(), Kernel());
    Delaunay delaunay;
    Cell hint;
    for (std::size_t i = 0; i < points.size(); ++i) {
        hint = delaunay.insert(points[i], hint)->cell();
        if (progress && i % 4096 == 0) progress(double(i) / double(points.size()));
    }
    return delaunay;
}

/// Numbers the filled cells by component and returns the volume of each.
std::vector<double> fill(Delaunay& delaunay, double probe_radius) {
    constexpr std::int32_t unvisited = std::numeric_limits<std::int32_t>::max();
    for (Cell cell : delaunay.finite_cell_handles())
        if (circumradius_at_most(cell, probe_radius)) cell->info().component = unvisited;

    std::vector<double> volumes;
    std::vector<Cell> front;
    for (Cell seed : delaunay.finite_cell_handles()) {
        if (seed->info().component != unvisited) continue;
        const auto number = std::int32_t(volumes.size());
        double sum = 0.0;
        seed->info().component = number;
        front.assign(1, seed);
        while (!front.empty()) {
            const Cell cell = front.back();
            front.pop_back();
            sum += volume(cell);
            for (int i = 0; i < 4; ++i) {
                const Cell next = cell->neighbor(i);
                if (next->info().component != unvisited) continue;
                next->info().component = number;
                front.push_back(next);
            }
        }
        volumes.push_back(sum);
    }
    return volumes;
}

/// A facet between a filled cell and an empty one: opposite to vertex `opposite` of the filled cell.
struct Facet {
    Cell cell;
    int opposite;
    Vertex corner(int k) const {
        // CGAL's triple looks into the cell.
        return cell->vertex(Delaunay::vertex_triple_index(opposite, 2 - k));
    }
};

std::vector<Facet> surface_facets(const Delaunay& delaunay) {
    std::vector<Facet> facets;
    for (Cell cell : delaunay.finite_cell_handles()) {
        if (!filled(cell)) continue;
        cell->info().first_facet = std::int32_t(facets.size());
        for (int i = 0; i < 4; ++i)
            if (!filled(cell->neighbor(i))) facets.push_back({cell, i});
    }
    return facets;
}

std::int32_t facet_number(Cell cell, int opposite) {
    std::int32_t number = cell->info().first_facet;
    for (int i = 0; i < opposite; ++i) number += !filled(cell->neighbor(i));
    return number;
}

/// The facet on the other side of the solid at the edge from corner k to corner k + 1: found by turning around the edge
/// through filled cells, so that two wedges that only share the edge stay apart.
std::int32_t facet_across(const Facet& facet, int k) {
    Cell cell = facet.cell;
    Vertex entered = cell->vertex(facet.opposite);
    Vertex third = facet.corner((k + 2) % 3);
    for (;;) {
        const int exit = cell->index(third);
        const Cell next = cell->neighbor(exit);
        if (!filled(next)) return facet_number(cell, exit);
        third = std::exchange(entered, next->vertex(next->index(cell)));
        cell = next;
    }
}

class DisjointSets {
 public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
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

/// Half-edge h = 3 f + k runs from corner k to corner k + 1 of facet f; across[h] is the half-edge that runs back.
std::vector<std::int32_t> opposite_half_edges(const std::vector<Facet>& facets) {
    std::vector<std::int32_t> across(3 * facets.size());
    for (std::size_t f = 0; f < facets.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const std::int32_t other = facet_across(facets[f], k);
            int back = 0;
            while (facets[other].corner(back) != facets[f].corner((k + 1) % 3)) ++back;
            across[3 * f + k] = 3 * other + back;
        }
    }
    return across;
}

/// One vertex for each fan of triangles around a point.
TriangleMesh joined_by_fans(const std::vector<Facet>& facets, const std::vector<std::int32_t>& across) {
    const auto next = [](std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
    DisjointSets fans(across.size());
    for (std::int32_t h = 0; h < std::int32_t(across.size()); ++h) fans.join(h, next(across[h]));

    TriangleMesh mesh;
    std::vector<std::int32_t> vertex_of(across.size(), -1);
    mesh.triangles.resize(facets.size());
    for (std::size_t f = 0; f < facets.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            std::int32_t& vertex = vertex_of[fans.root(std::int32_t(3 * f + k))];
            if (vertex < 0) {
                vertex = std::int32_t(mesh.vertices.size());
                mesh.vertices.push_back(vector(facets[f].corner(k)->point()));
            }
            mesh.triangles[f][k] = vertex;
        }
    }
    return mesh;
}

/// Different edges may still join the same two vertices, when a sheet touches itself along an edge; each of them gets a
/// vertex of its own in its middle.
void separate_parallel_edges(TriangleMesh& mesh, const std::vector<std::int32_t>& across) {
    struct Edge {
        std::int32_t low, high, half_edge;
        auto ends() const { return std::pair(low, high); }
    };
    std::vector<Edge> edges;
    edges.reserve(across.size() / 2);
    for (std::int32_t h = 0; h < std::int32_t(across.size()); ++h) {
        if (h > across[h]) continue;
        const auto& triangle = mesh.triangles[h / 3];
        const auto [low, high] = std::minmax({triangle[h % 3], triangle[(h + 1) % 3]});
        edges.push_back({low, high, h});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
    });

    std::vector<std::int32_t> middle(across.size(), -1);
    std::vector<std::int32_t> touched;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool parallel = (i > 0 && edges[i - 1].ends() == edges[i].ends()) ||
                              (i + 1 < edges.size() && edges[i + 1].ends() == edges[i].ends());
        if (!parallel) continue;
        const std::int32_t h = edges[i].half_edge;
        middle[h] = middle[across[h]] = std::int32_t(mesh.vertices.size());
        mesh.vertices.push_back(0.5 * (mesh.vertices[edges[i].low] + mesh.vertices[edges[i].high]));
        touched.push_back(h / 3);
        touched.push_back(across[h] / 3);
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());

    for (const std::int32_t f : touched) {
        std::vector<std::int32_t> outline;
        for (int k = 0; k < 3; ++k) {
            outline.push_back(mesh.triangles[f][k]);
            if (middle[3 * f + k] >= 0) outline.push_back(middle[3 * f + k]);
        }
        // A fan from a middle never makes a triangle of three points on one line.
        const auto first_middle = std::find_if(outline.begin(), outline.end(), [&](std::int32_t v) {
            return v != mesh.triangles[f][0] && v != mesh.triangles[f][1] && v != mesh.triangles[f][2];
        });
        std::rotate(outline.begin(), first_middle, outline.end());
        for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
            const std::array<std::int32_t, 3> part{outline[0], outline[i], outline[i + 1]};
            if (i == 1)
                mesh.triangles[f] = part;
            else
                mesh.triangles.push_back(part);
        }
    }
}

}  // namespace

AlphaSurface alpha_surface(std::span<const Vec3> centres, const AlphaSurfaceOptions& options) {
    if (!(options.probe_radius > 0.0) || !std::isfinite(options.probe_radius))
        throw InvalidInput(fmt::format("the probe radius is {} mm: expected more than 0", options.probe_radius));
    if (centres.size() < 4)
        throw InvalidInput(fmt::format("{} particle centres enclose no volume: at least 4 are needed", centres.size()));
    for (std::size_t i = 0; i < centres.size(); ++i)
        if (!centres[i].allFinite())
            throw InvalidInput(fmt::format("the centre of particle {} (counted from 0) is not a finite point", i));

    Delaunay delaunay = triangulate(centres, options.progress);
    if (delaunay.dimension() < 3)
        throw InvalidInput(
            fmt::format("the {} particle centres lie in one plane and enclose no volume", centres.size()));

    AlphaSurface surface;
    surface.components = fill(delaunay, options.probe_radius);
    if (surface.components.empty())
        throw InvalidInput(fmt::format(
            "a ball of {} mm passes between all {} particle centres: nothing is enclosed; give a larger probe radius",
            options.probe_radius, centres.size()));
    std::sort(surface.components.begin(), surface.components.end(), std::greater<>());
    surface.volume = std::accumulate(surface.components.rbegin(), surface.components.rend(), 0.0);

    const std::vector<Facet> facets = surface_facets(delaunay);
    const std::vector<std::int32_t> across = opposite_half_edges(facets);
    surface.mesh = joined_by_fans(facets, across);
    separate_parallel_edges(surface.mesh, across);
    surface.area = surface.mesh.area();
    if (options.progress) options.progress(1.0);
    return surface;
}

}  // namespace tomodem
