#include "core/surface/alpha_measures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace tomodem::alpha {

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

namespace {

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
constexpr std::int64_t min_inside = 50;
/// Share of the particles inside that a layer must leave, or the next one is the larger part of what is left.
constexpr double min_left = 0.3;

/// Mean volume of a particle, as deep inside as there are enough particles; 0 if there are not.
double inside_volume(const Shares& shares) {
    const double min = std::max(double(min_inside), min_left * double(shares[1].particles));
    for (std::int32_t depth = deepest; depth > 0; --depth)
        if (double(shares[depth].particles) >= min) return shares[depth].volume / double(shares[depth].particles);
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

}  // namespace

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
        const double own = shares[i][2].particles >= min_inside ? inside_volume(shares[i]) : 0.0;
        const double each = own > 0.0 ? own : surface.inside_volume;
        if (each > 0.0) body.corrected_volume = double(body.particles) * each;
    }
}

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

}  // namespace tomodem::alpha
