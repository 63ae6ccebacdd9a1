#include "core/surface/filling.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/packing/structure.hpp"
#include "core/surface/alpha_cells.hpp"

namespace tomodem {
namespace {

/// Circumradius of the tetrahedra that are taken, in seed radii. With a smaller one those that are taken are denser
/// than the packing, with a larger one some reach over the edge of a strut.
constexpr double close_together = 1.6;
constexpr std::int64_t enough_tetrahedra = 30;

/// Of the outermost centres from where the material ends, in diameters: 0.0 to 0.06 as cut, 0.05 to 0.13 relaxed, 0.08
/// to 0.17 pressed.
constexpr double hull_margin = 0.08;

/// At the corner from which the edges a, b, c begin. @see Van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30 (1983)
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    return 2.0 * std::atan2(std::abs(a.dot(b.cross(c))), la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
}

double circumradius(const std::array<Vec3, 4>& corner) {
    const Vec3 a = corner[1] - corner[0], b = corner[2] - corner[0], c = corner[3] - corner[0];
    const Vec3 centre = a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
    return centre.norm() / (2.0 * std::abs(a.dot(b.cross(c))));
}

}  // namespace

Filling filling_of(std::span<const Vec3> centres, double seed_radius) {
    std::vector<alpha::Point> points;
    points.reserve(centres.size());
    for (const Vec3& centre : centres) points.emplace_back(centre.x(), centre.y(), centre.z());
    const alpha::Delaunay delaunay(points.begin(), points.end());
    Filling filling;
    if (delaunay.dimension() < 3) return filling;

    double volume = 0.0, angles = 0.0, hull = 0.0, hull_area = 0.0;
    std::int64_t tetrahedra = 0;
    for (const alpha::Cell cell : delaunay.finite_cell_handles()) {
        const double size = alpha::volume(cell);
        hull += size;
        std::array<Vec3, 4> corner;
        for (int i = 0; i < 4; ++i) corner[i] = alpha::vector(cell->vertex(i)->point());
        if (!(circumradius(corner) <= close_together * seed_radius)) continue;
        ++tetrahedra;
        volume += size;
        for (int i = 0; i < 4; ++i)
            angles += solid_angle(corner[(i + 1) % 4] - corner[i], corner[(i + 2) % 4] - corner[i],
                                  corner[(i + 3) % 4] - corner[i]);
    }
    for (const alpha::Cell cell : delaunay.all_cell_handles()) {
        if (!delaunay.is_infinite(cell)) continue;
        const int beyond = cell->index(delaunay.infinite_vertex());
        const Vec3 a = alpha::vector(cell->vertex((beyond + 1) % 4)->point());
        const Vec3 b = alpha::vector(cell->vertex((beyond + 2) % 4)->point()) - a;
        const Vec3 c = alpha::vector(cell->vertex((beyond + 3) % 4)->point()) - a;
        hull_area += b.cross(c).norm() / 2.0;
    }
    filling.hull = hull + hull_margin * 2.0 * seed_radius * hull_area;
    if (tetrahedra < enough_tetrahedra) return filling;
    filling.particle = volume / (angles / (4.0 * std::numbers::pi));
    filling.solid = filling.particle * double(centres.size());
    return filling;
}

std::vector<std::int32_t> without_loose(std::span<const Vec3> centres, double seed_radius, int threads) {
    const NeighbourTable neighbours(centres, Box{Vec3::Zero(), Vec3::Ones()}, 4.0 * seed_radius, threads);
    std::vector<bool> seen(centres.size(), false);
    std::vector<std::int32_t> kept, group;
    for (std::size_t seed = 0; seed < centres.size(); ++seed) {
        if (seen[seed]) continue;
        seen[seed] = true;
        group.assign(1, std::int32_t(seed));
        for (std::size_t k = 0; k < group.size(); ++k)
            for (const std::int32_t other : neighbours.of(std::size_t(group[k])))
                if (!seen[std::size_t(other)]) {
                    seen[std::size_t(other)] = true;
                    group.push_back(other);
                }
        if (std::int64_t(group.size()) >= smallest_group) kept.insert(kept.end(), group.begin(), group.end());
    }
    if (kept.empty()) {
        kept.resize(centres.size());
        std::iota(kept.begin(), kept.end(), 0);
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

std::vector<Vec3> centres_of(std::span<const Vec3> centres, std::span<const std::int32_t> which) {
    std::vector<Vec3> chosen;
    chosen.reserve(which.size());
    for (const std::int32_t i : which) chosen.push_back(centres[std::size_t(i)]);
    return chosen;
}

bool is_open(const Filling& filling) {
    return filling.solid > 0.0 && filling.solid < 0.5 * filling.hull;
}

}  // namespace tomodem
