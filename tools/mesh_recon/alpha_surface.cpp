#include "tools/mesh_recon/alpha_surface.hpp"

#include <fmt/format.h>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "tools/mesh_recon/envelope.hpp"

namespace tomodem {
namespace {

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
    using Numbered = std::pair<Point, std::int32_t>;
    std::vector<Numbered> points;
    points.reserve(centres.size());
    for (const Vec3& centre : centres)
        points.emplace_back(Point(centre.x(), centre.y(), centre.z()), std::int32_t(points.size()));
    // What the range insertion of CGAL does, with a progress report in the loop.
    CGAL::spatial_sort(points.begin(), points.end(),
                       CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::First_of_pair_property_map<Numbered>>());
    Delaunay delaunay;
    Cell hint;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vertex vertex = delaunay.insert(points[i].first, hint);
        std::int32_t& centre = vertex->info().centre;
        centre = centre < 0 ? points[i].second : std::min(centre, points[i].second);
        hint = vertex->cell();
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
TriangleMesh joined_by_fans(const std::vector<Facet>& facets, const std::vector<std::int32_t>& across,
                            std::vector<std::int32_t>& centre_of_vertex) {
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
                centre_of_vertex.push_back(facets[f].corner(k)->info().centre);
            }
            mesh.triangles[f][k] = vertex;
        }
    }
    return mesh;
}

/// Different edges may still join the same two vertices, when a sheet touches itself along an edge; each of them gets a
/// vertex of its own in its middle.
/// @return  the facet of each triangle that this adds
std::vector<std::int32_t> separate_parallel_edges(TriangleMesh& mesh, const std::vector<std::int32_t>& across) {
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

    std::vector<std::int32_t> added;
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
            if (i == 1) {
                mesh.triangles[f] = part;
            } else {
                mesh.triangles.push_back(part);
                added.push_back(f);
            }
        }
    }
    return added;
}

/// Void parts: empty cells connected through facets or edges. The solid is connected through facets alone, so neither
/// passes where the other does, and each shell of the mesh is the outside of one part of the solid or of one void.
struct Voids {
    DisjointSets sets{1};
    bool outside(std::int32_t part) { return sets.root(part) == sets.root(0); }
};

std::int32_t void_beyond(const Facet& facet) {
    return facet.cell->neighbor(facet.opposite)->info().first_facet;
}

Voids number_voids(Delaunay& delaunay, const std::vector<Facet>& facets, const std::vector<std::int32_t>& across) {
    std::int32_t count = 1;  // 0 is the outside
    for (Cell cell : delaunay.all_cell_handles())
        if (!filled(cell)) cell->info().first_facet = delaunay.is_infinite(cell) ? 0 : count++;
    Voids voids{DisjointSets(count)};
    for (Cell cell : delaunay.all_cell_handles()) {
        if (filled(cell)) continue;
        for (int i = 0; i < 4; ++i) {
            cell->vertex(i)->info().at_void = true;
            const Cell next = cell->neighbor(i);
            if (!filled(next)) voids.sets.join(cell->info().first_facet, next->info().first_facet);
        }
    }
    // The empty cells around an edge lie between wedges of filled ones.
    for (std::size_t h = 0; h < across.size(); ++h)
        voids.sets.join(void_beyond(facets[h / 3]), void_beyond(facets[across[h] / 3]));
    return voids;
}

/// Old number of each new place, by falling volume (the first of equals stays first).
std::vector<std::int32_t> order_by_volume(const std::vector<Body>& bodies) {
    std::vector<std::int32_t> order(bodies.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t a, std::int32_t b) { return bodies[a].volume > bodies[b].volume; });
    return order;
}

std::vector<std::int32_t> inverse(const std::vector<std::int32_t>& order) {
    std::vector<std::int32_t> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = std::int32_t(i);
    return place;
}

Vec3 middle(Cell cell) {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 4; ++i) sum += vector(cell->vertex(i)->point());
    return sum / 4.0;
}

/// Volume that particles within the matter have: a quarter of each tetrahedron around them.
struct Share {
    double volume = 0.0;
    std::int64_t particles = 0;
};

/// The particles next to those at a void are chosen by having small tetrahedra around them, which makes their share too
/// small; with every layer that is left out the bias falls.
constexpr std::int32_t deepest = deepest_centre;
using Shares = std::array<Share, deepest + 1>;  // of the particles of at least that depth

/// Fewer particles than this say too little of a body.
constexpr std::int64_t least_inside = 50;
/// Share of the particles inside that a layer must leave, or the next one is most of what is left.
constexpr double least_left = 0.3;

/// Mean volume of a particle, as deep inside as there are enough particles; 0 if there are not.
double inside_volume(const Shares& shares) {
    const double least = std::max(double(least_inside), least_left * double(shares[1].particles));
    for (std::int32_t depth = deepest; depth > 0; --depth)
        if (double(shares[depth].particles) >= least) return shares[depth].volume / double(shares[depth].particles);
    return 0.0;
}

void set_depths(Delaunay& delaunay) {
    for (Vertex vertex : delaunay.finite_vertex_handles()) vertex->info().depth = vertex->info().at_void ? 0 : deepest;
    for (std::int32_t depth = 1; depth < deepest; ++depth)
        for (Cell cell : delaunay.finite_cell_handles()) {
            if (!filled(cell)) continue;
            bool next = false;
            for (int i = 0; i < 4; ++i) next |= cell->vertex(i)->info().depth == depth - 1;
            if (!next) continue;
            for (int i = 0; i < 4; ++i) {
                std::int32_t& own = cell->vertex(i)->info().depth;
                own = std::min(own, depth);
            }
        }
}

/// Centres of no filled tetrahedron stick out of a surface: each goes to the body of the nearest centre that has one,
/// if that is within the probe radius.
void add_touching(const Delaunay& delaunay, double probe_radius, std::vector<std::int32_t>& body_of_centre) {
    std::vector<std::pair<std::int32_t, std::int32_t>> found;
    std::vector<Vertex> neighbours;
    for (Vertex vertex : delaunay.finite_vertex_handles()) {
        const std::int32_t centre = vertex->info().centre;
        if (body_of_centre[centre] >= 0) continue;
        neighbours.clear();
        delaunay.finite_adjacent_vertices(vertex, std::back_inserter(neighbours));
        std::pair<double, std::int32_t> nearest{probe_radius, -1};
        for (Vertex other : neighbours) {
            const std::int32_t body = body_of_centre[other->info().centre];
            const double distance = (vector(other->point()) - vector(vertex->point())).norm();
            if (body >= 0 && distance <= nearest.first) nearest = {distance, body};
        }
        if (nearest.second >= 0) found.emplace_back(centre, nearest.second);
    }
    for (const auto& [centre, body] : found) body_of_centre[centre] = body;
}

void measure_bodies(Delaunay& delaunay, const std::vector<double>& volumes, const AlphaSurfaceOptions& options,
                    AlphaSurface& surface) {
    const auto particles = std::int32_t(surface.body_of_centre.size() - options.auxiliary);
    for (Vertex vertex : delaunay.finite_vertex_handles())
        if (vertex->info().centre >= particles) vertex->info().at_void = true;  // as if nothing were there
    std::vector<Body> bodies(volumes.size());
    for (std::size_t i = 0; i < volumes.size(); ++i) bodies[i].volume = volumes[i];
    const std::vector<std::int32_t> order = order_by_volume(bodies), place = inverse(order);
    for (const std::int32_t old : order) surface.bodies.push_back(bodies[old]);

    set_depths(delaunay);
    std::vector<Shares> shares(volumes.size());
    for (Cell cell : delaunay.finite_cell_handles()) {
        if (!filled(cell)) continue;
        const std::int32_t number = cell->info().component = place[cell->info().component];
        const double size = volume(cell);
        surface.bodies[number].centre += size * middle(cell);
        for (int i = 0; i < 4; ++i) {
            const VertexInfo& info = cell->vertex(i)->info();
            for (std::int32_t d = 1; d <= info.depth; ++d) shares[number][d].volume += size / 4.0;
            surface.share[info.centre] += size / 4.0;
            surface.depth[info.centre] = static_cast<std::int8_t>(info.depth);
            std::int32_t& body = surface.body_of_centre[info.centre];
            if (body < 0 || number < body) body = number;
        }
    }
    add_touching(delaunay, options.probe_radius, surface.body_of_centre);
    for (Vertex vertex : delaunay.finite_vertex_handles()) {
        const std::int32_t body = surface.body_of_centre[vertex->info().centre];
        if (body < 0 || vertex->info().centre >= particles) continue;
        ++surface.bodies[body].particles;
        for (std::int32_t d = 1; d <= vertex->info().depth; ++d) ++shares[body][d].particles;
    }
    Shares all;
    for (const Shares& own : shares)
        for (std::int32_t d = 1; d <= deepest; ++d) {
            all[d].volume += own[d].volume;
            all[d].particles += own[d].particles;
        }
    surface.inside_volume = inside_volume(all);
    for (std::size_t i = 0; i < surface.bodies.size(); ++i) {
        Body& body = surface.bodies[i];
        body.centre /= body.volume;
        // A small body is better off with the mean over all.
        const double own = shares[i][2].particles >= least_inside ? inside_volume(shares[i]) : 0.0;
        const double each = own > 0.0 ? own : surface.inside_volume;
        if (each > 0.0) body.corrected_volume = double(body.particles) * each;
    }
}

/// @return  the pore of each void part; -1: outside
std::vector<std::int32_t> measure_pores(Delaunay& delaunay, Voids& voids, AlphaSurface& surface) {
    std::vector<std::int32_t> pore_of_part(voids.sets.size(), -1);
    std::vector<Body> pores;
    std::vector<std::vector<std::int32_t>> centres;
    for (Cell cell : delaunay.finite_cell_handles()) {
        if (filled(cell) || voids.outside(cell->info().first_facet)) continue;
        std::int32_t& pore = pore_of_part[voids.sets.root(cell->info().first_facet)];
        if (pore < 0) {
            pore = std::int32_t(pores.size());
            pores.emplace_back();
            centres.emplace_back();
        }
        const double size = volume(cell);
        pores[pore].volume += size;
        pores[pore].centre += size * middle(cell);
        for (int i = 0; i < 4; ++i) centres[pore].push_back(cell->vertex(i)->info().centre);
    }
    const std::vector<std::int32_t> order = order_by_volume(pores), place = inverse(order);
    for (const std::int32_t old : order) {
        Body& pore = surface.pores.emplace_back(pores[old]);
        std::vector<std::int32_t>& around = surface.centres_of_pore.emplace_back(std::move(centres[old]));
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        pore.particles = std::int64_t(around.size());
        pore.centre /= pore.volume;
    }
    for (std::int32_t& pore : pore_of_part)
        if (pore >= 0) pore = place[pore];
    for (std::size_t part = 0; part < pore_of_part.size(); ++part)
        pore_of_part[part] = pore_of_part[voids.sets.root(std::int32_t(part))];
    return pore_of_part;
}

/// Shells, genus and area of every body and pore, from the mesh before its parallel edges are separated.
void measure_shells(const std::vector<Facet>& facets, const std::vector<std::int32_t>& across, AlphaSurface& surface) {
    DisjointSets shells(facets.size());
    for (std::size_t h = 0; h < across.size(); ++h) shells.join(std::int32_t(h / 3), across[h] / 3);
    struct Count {
        std::int64_t vertices = 0, triangles = 0;
    };
    std::vector<Count> counts(facets.size());
    std::vector<bool> seen(surface.mesh.vertices.size(), false);
    const auto add = [&](std::size_t f, const auto& change) {
        change(surface.bodies[surface.body_of_triangle[f]]);
        if (surface.pore_of_triangle[f] >= 0) change(surface.pores[surface.pore_of_triangle[f]]);
    };
    for (std::size_t f = 0; f < facets.size(); ++f) {
        const auto& [a, b, c] = surface.mesh.triangles[f];
        const Vec3 origin = surface.mesh.vertices[a];
        const double area = (surface.mesh.vertices[b] - origin).cross(surface.mesh.vertices[c] - origin).norm() / 2.0;
        add(f, [&](Body& body) { body.area += area; });
        Count& count = counts[shells.root(std::int32_t(f))];
        ++count.triangles;
        for (const std::int32_t v : {a, b, c}) {
            count.vertices += !seen[v];
            seen[v] = true;
        }
    }
    for (std::size_t f = 0; f < facets.size(); ++f) {
        if (counts[f].triangles == 0) continue;
        const std::int64_t euler = counts[f].vertices - counts[f].triangles / 2;
        add(f, [&](Body& body) {
            ++body.shells;
            body.genus += 1 - euler / 2;
        });
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

    const std::vector<double> volumes = fill(delaunay, options.probe_radius);
    if (volumes.empty())
        throw InvalidInput(fmt::format(
            "a ball of {} mm passes between all {} particle centres: nothing is enclosed; give a larger probe radius",
            options.probe_radius, centres.size()));

    AlphaSurface surface;
    surface.body_of_centre.assign(centres.size(), -1);
    surface.share.assign(centres.size(), 0.0);
    surface.depth.assign(centres.size(), 0);
    const std::vector<Facet> facets = surface_facets(delaunay);
    const std::vector<std::int32_t> across = opposite_half_edges(facets);
    Voids voids = number_voids(delaunay, facets, across);
    measure_bodies(delaunay, volumes, options, surface);
    const std::vector<std::int32_t> pore_of_part = measure_pores(delaunay, voids, surface);
    for (const Body& body : surface.bodies) surface.components.push_back(body.volume);
    surface.volume = std::accumulate(surface.components.rbegin(), surface.components.rend(), 0.0);
    surface.outside.assign(centres.size(), false);
    for (Cell cell : delaunay.all_cell_handles())
        if (!filled(cell) && voids.outside(cell->info().first_facet))
            for (int i = 0; i < 4; ++i)
                if (const std::int32_t centre = cell->vertex(i)->info().centre; centre >= 0)
                    surface.outside[centre] = true;
    for (const Facet& facet : facets) {
        surface.body_of_triangle.push_back(facet.cell->info().component);
        surface.pore_of_triangle.push_back(pore_of_part[void_beyond(facet)]);
    }
    surface.mesh = joined_by_fans(facets, across, surface.centre_of_vertex);
    measure_shells(facets, across, surface);
    for (const std::int32_t facet : separate_parallel_edges(surface.mesh, across)) {
        surface.body_of_triangle.push_back(surface.body_of_triangle[facet]);
        surface.pore_of_triangle.push_back(surface.pore_of_triangle[facet]);
    }
    surface.centre_of_vertex.resize(surface.mesh.vertices.size(), -1);
    surface.area = surface.mesh.area();
    if (options.seed_radius > 0.0 && surface.inside_volume > 0.0) {
        const double sphere = 4.0 / 3.0 * std::numbers::pi * std::pow(options.seed_radius, 3);
        for (Body& pore : surface.pores) {
            const double width = 3.0 * pore.volume / (pore.area * options.seed_radius);
            // Not calibrated below four particles across, where it would soon turn negative.
            const double bias =
                std::max(0.0, envelope_bias({options.seed_radius, sphere / surface.inside_volume}, width));
            pore.corrected_volume = std::max(0.0, pore.volume - bias * pore.area);
        }
    }
    if (options.progress) options.progress(1.0);
    return surface;
}

}  // namespace tomodem
