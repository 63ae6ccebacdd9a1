#include "core/surface/alpha_mesh.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace tomodem::alpha {

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

namespace {

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

}  // namespace

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

}  // namespace tomodem::alpha
