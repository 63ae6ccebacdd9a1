#include "tools/metrics/shapes/voxelised_run.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"

namespace tomodem::shapes {
namespace {

/// Points in cells, those of them that can be the nearest of a place in a box.
class Cells {
 public:
    Cells(std::span<const Vec3> points, double edge, const Vec3& box_low, const Vec3& box_high)
        : points_(points), edge_(edge) {
        low_ = points.front();
        Vec3 high = low_;
        for (const Vec3& p : points) {
            low_ = low_.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        low_ = low_.cwiseMax(box_low - Vec3::Constant(edge));
        high = high.cwiseMin(box_high + Vec3::Constant(edge));
        for (int c = 0; c < 3; ++c)
            count_[c] =
                std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((high[c] - low_[c]) / edge)) + 1);
        first_.assign(std::size_t(count_[0] * count_[1] * count_[2]) + 1, 0);
        std::vector<std::int64_t> cell(points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            if ((cell[i] = number(points[i])) >= 0) ++first_[cell[i] + 1];
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
        in_.resize(first_.back());
        for (std::size_t i = 0; i < points.size(); ++i)
            if (cell[i] >= 0) in_[next[cell[i]]++] = static_cast<std::int32_t>(i);
    }

    /// The nearest point within an edge, of equals the first; -1: none.
    std::int32_t nearest(const Vec3& place) const {
        std::array<std::int64_t, 3> from, to;
        for (int c = 0; c < 3; ++c) {
            const auto cell = static_cast<std::int64_t>(std::floor((place[c] - low_[c]) / edge_));
            from[c] = std::max<std::int64_t>(0, cell - 1);
            to[c] = std::min(count_[c] - 1, cell + 1);
        }
        std::int32_t best = -1;
        double nearest = edge_ * edge_;
        for (std::int64_t z = from[2]; z <= to[2]; ++z)
            for (std::int64_t y = from[1]; y <= to[1]; ++y)
                for (std::int64_t x = from[0]; x <= to[0]; ++x) {
                    const std::int64_t cell = (z * count_[1] + y) * count_[0] + x;
                    for (std::int32_t at = first_[cell]; at < first_[cell + 1]; ++at) {
                        const double distance = (points_[in_[at]] - place).squaredNorm();
                        if (distance < nearest || (distance == nearest && in_[at] < best)) {
                            nearest = distance;
                            best = in_[at];
                        }
                    }
                }
        return best;
    }

 private:
    /// -1: in none
    std::int64_t number(const Vec3& p) const {
        std::array<std::int64_t, 3> cell;
        for (int c = 0; c < 3; ++c) {
            cell[c] = static_cast<std::int64_t>(std::floor((p[c] - low_[c]) / edge_));
            if (cell[c] < 0 || cell[c] >= count_[c]) return -1;
        }
        return (cell[2] * count_[1] + cell[1]) * count_[0] + cell[0];
    }
    std::span<const Vec3> points_;
    double edge_;
    Vec3 low_;
    std::array<std::int64_t, 3> count_{};
    std::vector<std::int32_t> first_, in_;
};

/// Is a point of the plane (y, z) to the left of the way from a to b? The same for b to a but for the sign, to the bit.
bool left_of(const Vec3& a, const Vec3& b, std::int32_t number_a, std::int32_t number_b, double y, double z) {
    if (number_a > number_b) return !left_of(b, a, number_b, number_a, y, z);
    return (b.y() - a.y()) * (z - a.z()) - (b.z() - a.z()) * (y - a.y()) >= 0.0;
}

/// The surface of the matter where it ends: the outside is moved until all bodies have their corrected volume, pores
/// until they have theirs, which is another distance. Pores with less than a particle's volume are matter.
TriangleMesh edge_of_matter(const AlphaSurface& surface) {
    constexpr std::int32_t none = -1;
    std::vector<std::int32_t> host(surface.pores.size(), none);  // the largest body around each pore
    std::vector<bool> has_outside(surface.bodies.size(), false);
    SurfacePart outside{surface.mesh, {}};
    outside.mesh.triangles.clear();
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const std::int32_t body = surface.body_of_triangle[t], pore = surface.pore_of_triangle[t];
        if (pore >= 0) {
            if (host[pore] == none || body < host[pore]) host[pore] = body;
            continue;
        }
        has_outside[body] = true;
        outside.mesh.triangles.push_back(surface.mesh.triangles[t]);
        outside.number.push_back(body);
    }
    std::vector<bool> kept(surface.pores.size());
    std::vector<Body> enclosed = surface.bodies;
    for (std::size_t p = 0; p < surface.pores.size(); ++p) {
        kept[p] = surface.pores[p].corrected_volume >= surface.inside_volume;
        if (kept[p]) enclosed[host[p]].corrected_volume += surface.pores[p].corrected_volume;
    }
    std::vector<bool> counted = has_outside;  // of the others each is an island in a pore
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        const std::int32_t body = surface.body_of_triangle[t], pore = surface.pore_of_triangle[t];
        if (counted[body] || host[pore] == body) continue;
        enclosed[host[pore]].corrected_volume += surface.bodies[body].corrected_volume;
        counted[body] = true;
    }
    correct_envelope(outside, enclosed);
    SurfacePart pores = pore_surface(surface);
    correct_envelope(pores, surface.pores);

    TriangleMesh mesh = std::move(outside.mesh);
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), pores.mesh.vertices.begin(), pores.mesh.vertices.end());
    for (std::size_t t = 0; t < pores.mesh.triangles.size(); ++t) {
        if (!kept[pores.number[t]]) continue;
        const auto& [a, b, c] = pores.mesh.triangles[t];
        mesh.triangles.push_back({first + a, first + c, first + b});
    }
    return mesh;
}

}  // namespace

void for_each_row_inside(const TriangleMesh& mesh, const Grid& grid, int threads, const RowVisit& row) {
    // In voxels, whose centres are whole numbers; rays miss the corners of what lies on a lattice.
    std::vector<Vec3> points;
    for (const Vec3& p : mesh.vertices)
        points.push_back((p - grid.origin).cwiseQuotient(grid.spacing) - Vec3::Constant(0.5));
    const Vec3 aside(0.0, 1.3e-7, 2.9e-7);
    for (Vec3& p : points) p += aside;

    const auto range = [](double a, double b, double c, std::int32_t count) {
        const auto [low, high] = std::minmax({a, b, c});
        return std::pair(static_cast<std::int32_t>(std::clamp(std::ceil(low), 0.0, double(count))),
                         static_cast<std::int32_t>(std::clamp(std::floor(high) + 1.0, 0.0, double(count))));
    };
    std::vector<std::vector<std::int32_t>> of_slice(grid.size[2]);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const auto [from, to] = range(points[a].z(), points[b].z(), points[c].z(), grid.size[2]);
        for (std::int32_t k = from; k < to; ++k) of_slice[k].push_back(static_cast<std::int32_t>(t));
    }
    parallel_for(grid.size[2], threads, [&](std::int64_t slice) {
        struct Crossing {
            std::int32_t row;
            double x;
            int turn;
        };
        std::vector<Crossing> crossings;
        const auto k = static_cast<std::int32_t>(slice);
        for (const std::int32_t t : of_slice[slice]) {
            const auto& corner = mesh.triangles[t];
            const Vec3 &a = points[corner[0]], &b = points[corner[1]], &c = points[corner[2]];
            const Vec3 normal = (b - a).cross(c - a);
            const auto [from, to] = range(a.y(), b.y(), c.y(), grid.size[1]);
            for (std::int32_t j = from; j < to; ++j) {
                const bool ab = left_of(a, b, corner[0], corner[1], j, k);
                if (left_of(b, c, corner[1], corner[2], j, k) != ab || left_of(c, a, corner[2], corner[0], j, k) != ab)
                    continue;
                // Facing away from x the way goes inside.
                const double x = a.x() - (normal.y() * (j - a.y()) + normal.z() * (k - a.z())) / normal.x();
                crossings.push_back({j, x, ab ? -1 : 1});
            }
        }
        std::sort(crossings.begin(), crossings.end(), [](const Crossing& p, const Crossing& q) {
            return std::tie(p.row, p.x, p.turn) < std::tie(q.row, q.x, q.turn);
        });
        int around = 0;
        for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
            if (i == 0 || crossings[i].row != crossings[i - 1].row) around = 0;
            around += crossings[i].turn;
            if (around <= 0 || crossings[i + 1].row != crossings[i].row) continue;
            const double width = grid.size[0];
            const auto first = static_cast<std::int32_t>(std::clamp(std::ceil(crossings[i].x), 0.0, width));
            const auto last = static_cast<std::int32_t>(std::clamp(std::ceil(crossings[i + 1].x), 0.0, width));
            if (first < last) row(crossings[i].row, k, first, last);
        }
    });
}

VoxelisedRun voxelise(const Packing& packing, const AlphaSurface& surface, const Grid& grid, int threads) {
    const double diameter = default_probe_radius(packing.seed_radius);
    const TriangleMesh edge = edge_of_matter(surface);
    VoxelisedRun result{LabelVolume(grid.size, grid.spacing, grid.origin),
                        LabelVolume(grid.size, grid.spacing, grid.origin), edge.volume()};

    const Vec3 extent = grid.spacing.cwiseProduct(Vec3(grid.size[0], grid.size[1], grid.size[2]));
    const Cells cells(packing.position, diameter, grid.origin, grid.origin + extent);
    const std::int64_t width = grid.size[0], page = width * grid.size[1];
    // Slabs, so that no more than a few slices are held voxel by voxel.
    constexpr std::int32_t depth = 8 * LabelVolume::slab;
    std::vector<std::int32_t> species, object;
    for (std::int32_t k0 = 0; k0 < grid.size[2]; k0 += depth) {
        Grid slab = grid;
        slab.size[2] = std::min(depth, grid.size[2] - k0);
        slab.origin.z() += k0 * grid.spacing.z();
        species.assign(page * slab.size[2], 0);
        object.assign(page * slab.size[2], 0);
        for_each_row_inside(edge, slab, threads, [&](std::int32_t j, std::int32_t k, std::int32_t i0, std::int32_t i1) {
            for (std::int32_t i = i0; i < i1; ++i) {
                const Vec3 centre = slab.origin + slab.spacing.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5));
                const std::int32_t particle = cells.nearest(centre);
                if (particle < 0) continue;
                const std::int64_t at = k * page + j * width + i;
                species[at] = packing.species[particle];
                if (!packing.object.empty()) object[at] = packing.object[particle];
            }
        });
        result.species.set_slices(k0, slab.size[2], species);
        result.object.set_slices(k0, slab.size[2], object);
    }
    return result;
}

}  // namespace tomodem::shapes
