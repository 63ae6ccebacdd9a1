#include "tools/relax/pore_measure.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/spatial_sort.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace tomodem::relax {
namespace {

enum class CellState : unsigned char { full, empty, counted };

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<CellState, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Kernel>, CellBase>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
using Cell = Delaunay::Cell_handle;

Vec3 vector(const Kernel::Point_3& p) {
    return {p.x(), p.y(), p.z()};
}

Vec3 corner(Cell cell, int i) {
    return vector(cell->vertex(i)->point());
}

Vec3 middle(Cell cell) {
    return (corner(cell, 0) + corner(cell, 1) + corner(cell, 2) + corner(cell, 3)) / 4;
}

double six_volumes(Cell cell) {
    const Vec3 a = corner(cell, 0);
    return (corner(cell, 1) - a).cross(corner(cell, 2) - a).dot(corner(cell, 3) - a);
}

bool fits(Cell cell, double probe_radius) {
    const Vec3 origin = corner(cell, 0);
    const Vec3 a = corner(cell, 1) - origin, b = corner(cell, 2) - origin, c = corner(cell, 3) - origin;
    const double determinant = a.dot(b.cross(c));
    const Vec3 numerator = a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
    return numerator.squaredNorm() > 4 * probe_radius * probe_radius * determinant * determinant;
}

}  // namespace

double Mirrors::copies() const {
    double count = 1;
    for (const int one : side) count *= one == 0 ? 1 : 2;
    return count;
}

Vec3 Mirrors::fold(const Vec3& point) const {
    Vec3 folded = point;
    for (int c = 0; c < 3; ++c)
        if (side[c] * (point[c] - plane[c]) > 0) folded[c] = 2 * plane[c] - point[c];
    return folded;
}

double Mirrors::share(const Vec3& point, double edge) const {
    double part = 1;
    for (int c = 0; c < 3; ++c)
        if (side[c] != 0) part *= std::clamp(side[c] * (plane[c] - point[c]) / edge + 0.5, 0.0, 1.0);
    return part;
}

std::vector<Vec3> Mirrors::with_images(std::span<const Vec3> centres, double seed_radius) const {
    std::vector<Vec3> all(centres.begin(), centres.end());
    std::minstd_rand random(1);
    std::uniform_real_distribution<double> off(-1e-3 * seed_radius, 1e-3 * seed_radius);
    for (int c = 0; c < 3; ++c) {
        if (side[c] == 0) continue;
        const std::size_t count = all.size();
        for (std::size_t i = 0; i < count; ++i) {
            Vec3 image = all[i];
            image[c] = 2 * plane[c] - image[c];
            all.push_back(image + Vec3(off(random), off(random), off(random)));
        }
    }
    return all;
}

double grid_bias(const Matter& matter, double across) {
    return (0.823 - 0.71 * (matter.density - 0.64) - 0.45 / across) * matter.seed_radius;
}

PoreMeasure measure_pore(std::span<const Vec3> centres, const DistanceField& image, const Belongs& belongs,
                         const Matter& matter, const Mirrors& mirrors) {
    PoreMeasure measured;
    const std::vector<Vec3> all = mirrors.with_images(centres, matter.seed_radius);
    std::vector<Kernel::Point_3> points;
    points.reserve(all.size());
    for (const Vec3& centre : all) points.emplace_back(centre.x(), centre.y(), centre.z());
    CGAL::spatial_sort(points.begin(), points.end(), Kernel());
    Delaunay delaunay;
    for (Cell hint; const auto& point : points) hint = delaunay.insert(point, hint)->cell();
    if (delaunay.dimension() < 3) return measured;

    const double probe = 2 * matter.seed_radius;
    std::vector<Cell> front;
    for (Cell cell : delaunay.all_cell_handles()) cell->info() = CellState::full;
    for (Cell cell : delaunay.finite_cell_handles())
        if (fits(cell, probe)) cell->info() = CellState::empty;
    for (Cell cell : delaunay.finite_cell_handles())
        if (cell->info() == CellState::empty) {
            const Vec3 point = mirrors.fold(middle(cell));
            if (image.at(point) < 0 && belongs(point)) {
                cell->info() = CellState::counted;
                front.push_back(cell);
            }
        }
    double first_moment = 0, second_moment = 0;
    while (!front.empty()) {
        const Cell cell = front.back();
        front.pop_back();
        measured.envelope += six_volumes(cell) / 6;
        for (int i = 0; i < 4; ++i) {
            const Cell next = cell->neighbor(i);
            if (next->info() == CellState::empty && belongs(mirrors.fold(middle(next)))) {
                next->info() = CellState::counted;
                front.push_back(next);
            }
            if (next->info() == CellState::counted) continue;
            if (next->info() == CellState::empty || delaunay.is_infinite(next)) {
                measured.leaks = true;
                continue;
            }
            const Vec3 a = corner(cell, (i + 1) & 3), b = corner(cell, (i + 2) & 3), c = corner(cell, (i + 3) & 3);
            const double area = (b - a).cross(c - a).norm() / 2;
            const double distance = image.at(mirrors.fold((a + b + c) / 3));
            if (!std::isfinite(distance)) continue;
            measured.area += area;
            first_moment += area * distance;
            second_moment += area * distance * distance;
        }
    }
    if (measured.area > 0) {
        const double mean = first_moment / measured.area;
        measured.spread = std::sqrt(std::max(0.0, second_moment / measured.area - mean * mean));
        const double across = 6 * measured.envelope / measured.area / probe;
        const double bias = envelope_bias(matter, across);
        measured.distance = mean - bias;
        measured.volume = std::max(0.0, measured.envelope - bias * measured.area) / mirrors.copies();
        measured.envelope /= mirrors.copies();
        measured.area /= mirrors.copies();
    }
    return measured;
}

PoreOverlap overlap_pore(std::span<const Vec3> centres, const DistanceField& image, const Belongs& belongs,
                         const Matter& matter, double across, const Mirrors& mirrors) {
    const double probe = 2 * matter.seed_radius, step = matter.seed_radius / 2;
    const Vec3& corner = image.low();
    VoxelIndex size;
    for (int c = 0; c < 3; ++c) size[c] = static_cast<std::int32_t>((image.high()[c] - corner[c]) / step) + 1;
    std::vector<bool> free(std::size_t(size[0]) * size[1] * size[2], true);
    for (const Vec3& centre : mirrors.with_images(centres, matter.seed_radius)) {
        const Vec3 place = (centre - corner) / step;
        std::int32_t from[3], to[3];
        for (int c = 0; c < 3; ++c) {
            from[c] = std::max(0, static_cast<std::int32_t>(std::ceil(place[c] - probe / step)));
            to[c] = std::min(size[c] - 1, static_cast<std::int32_t>(std::floor(place[c] + probe / step)));
        }
        for (std::int32_t z = from[2]; z <= to[2]; ++z)
            for (std::int32_t y = from[1]; y <= to[1]; ++y) {
                const double rest =
                    probe * probe / (step * step) - (z - place[2]) * (z - place[2]) - (y - place[1]) * (y - place[1]);
                if (rest < 0) continue;
                const double half = std::sqrt(rest);
                const std::int32_t first = std::max(from[0], static_cast<std::int32_t>(std::ceil(place[0] - half)));
                const std::int32_t last = std::min(to[0], static_cast<std::int32_t>(std::floor(place[0] + half)));
                const std::size_t row = (std::size_t(z) * size[1] + y) * size[0];
                for (std::int32_t x = first; x <= last; ++x) free[row + x] = false;
            }
    }
    const std::vector<float> distance = squared_distances(free, size, Vec3::Constant(step));
    const double limit = probe - grid_bias(matter, across * std::cbrt(mirrors.copies()));
    PoreOverlap overlap;
    const double cube = step * step * step;
    std::vector<bool> joined(distance.size(), false), inside(distance.size(), false);
    std::vector<std::array<std::int32_t, 3>> front;
    const auto place = [&](const std::array<std::int32_t, 3>& p) {
        return (std::size_t(p[2]) * size[1] + p[1]) * size[0] + p[0];
    };
    const auto point = [&](const std::array<std::int32_t, 3>& p) -> Vec3 {
        return corner + step * Vec3(p[0], p[1], p[2]);
    };
    // A point stands for a cube: one that the edge or a plane cuts counts in part.
    const auto material = [&](const std::array<std::int32_t, 3>& p) { return mirrors.share(point(p), step); };
    const auto share = [&](const std::array<std::int32_t, 3>& p) {
        return material(p) * std::clamp((limit - std::sqrt(distance[place(p)])) / step + 0.5, 0.0, 1.0);
    };
    for (std::int32_t z = 0; z < size[2]; ++z)
        for (std::int32_t y = 0; y < size[1]; ++y)
            for (std::int32_t x = 0; x < size[0]; ++x) {
                const std::array<std::int32_t, 3> here{x, y, z};
                if (!(image.at(point(here)) < 0) || !belongs(mirrors.fold(point(here)))) continue;
                const std::size_t at = place(here);
                inside[at] = true;
                overlap.image += cube * material(here);
                if (share(here) == 0) continue;
                joined[at] = true;
                front.push_back(here);
            }
    overlap.united = overlap.image;
    while (!front.empty()) {
        const std::array<std::int32_t, 3> here = front.back();
        front.pop_back();
        const std::size_t at = place(here);
        overlap.volume += cube * share(here);
        (inside[at] ? overlap.intersection : overlap.united) += cube * share(here);
        for (int axis = 0; axis < 3; ++axis)
            for (const int way : {-1, 1}) {
                std::array<std::int32_t, 3> next = here;
                next[axis] += way;
                if (next[axis] < 0 || next[axis] >= size[axis]) continue;
                const std::size_t there = place(next);
                if (joined[there] || share(next) == 0 || !belongs(mirrors.fold(point(next)))) continue;
                joined[there] = true;
                front.push_back(next);
            }
    }
    return overlap;
}

}  // namespace tomodem::relax
