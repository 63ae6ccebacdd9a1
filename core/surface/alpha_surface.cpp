#include "core/surface/alpha_surface.hpp"

#include <fmt/format.h>

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/surface/alpha_cells.hpp"
#include "core/surface/alpha_measures.hpp"
#include "core/surface/alpha_mesh.hpp"
#include "core/surface/envelope.hpp"

namespace tomodem {

using namespace alpha;

namespace {

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
