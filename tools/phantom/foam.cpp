#include "tools/phantom/foam.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::phantom {
namespace {

/// A convex polyhedron as its faces, each a loop of corners.
using Polyhedron = std::vector<std::vector<Vec3>>;

Polyhedron cube(double half) {
    Polyhedron faces;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-half, half}) {
            const auto corner = [&](double u, double v) {
                Vec3 point;
                point[axis] = side;
                point[(axis + 1) % 3] = u;
                point[(axis + 2) % 3] = v;
                return point;
            };
            faces.push_back({corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)});
        }
    return faces;
}

/// Keeps the part where normal . x <= offset. Corners nearer to the plane than `same` lie on it.
void clip(Polyhedron& faces, const Vec3& normal, double offset, double same) {
    const double length = normal.norm();
    const auto above = [&](const Vec3& point) {
        const double height = (normal.dot(point) - offset) / length;
        return std::abs(height) < same ? 0.0 : height;
    };
    bool cuts = false;
    for (const auto& face : faces)
        for (const Vec3& corner : face) cuts = cuts || above(corner) > 0;
    if (!cuts) return;

    Polyhedron kept;
    std::vector<Vec3> cut;  // corners of the new face, each met on two faces or more
    for (const auto& face : faces) {
        std::vector<Vec3> loop;
        for (std::size_t i = 0; i < face.size(); ++i) {
            const Vec3 &here = face[i], &next = face[(i + 1) % face.size()];
            const double a = above(here), b = above(next);
            if (a <= 0) loop.push_back(here);
            if (a == 0) cut.push_back(here);
            if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
                loop.push_back(here + a / (a - b) * (next - here));
                cut.push_back(loop.back());
            }
        }
        if (loop.size() >= 3) kept.push_back(std::move(loop));
    }
    Vec3 centre = Vec3::Zero();
    for (const Vec3& corner : cut) centre += corner / static_cast<double>(cut.size());
    const Vec3 u = normal.unitOrthogonal(), v = normal.normalized().cross(u);
    const auto angle = [&](const Vec3& point) { return std::atan2(v.dot(point - centre), u.dot(point - centre)); };
    std::sort(cut.begin(), cut.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
    const auto equal = [&](const Vec3& a, const Vec3& b) { return (a - b).norm() < 2 * same; };
    cut.erase(std::unique(cut.begin(), cut.end(), equal), cut.end());
    while (cut.size() > 1 && equal(cut.front(), cut.back())) cut.pop_back();
    if (cut.size() >= 3) kept.push_back(std::move(cut));
    faces = std::move(kept);
}

double farthest_corner(const Polyhedron& faces) {
    double square = 0;
    for (const auto& face : faces)
        for (const Vec3& corner : face) square = std::max(square, corner.squaredNorm());
    return std::sqrt(square);
}

double square_distance(const Vec3& point, const Strut& strut) {
    const Vec3 line = strut.to - strut.from, reach = point - strut.from;
    const double along = std::clamp(reach.dot(line) / line.squaredNorm(), 0.0, 1.0);
    return (reach - along * line).squaredNorm();
}

/// Squared distance [voxels^2] of each voxel's centre to the nearest strut, where it is less than reach^2.
std::vector<float> square_distances(const std::vector<Strut>& struts, VoxelIndex size, double voxel_size, double reach,
                                    int threads, Reporter& reporter) {
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<float> distances(page * size[2], static_cast<float>(reach * reach));
    const std::int32_t slabs = (size[2] + LabelVolume::slab - 1) / LabelVolume::slab;
    const auto progress = reporter.progress("distances", slabs);
    std::mutex one_at_a_time;
    std::int32_t done = 0;
    parallel_for(slabs, threads, [&](std::int64_t slab) {
        const auto k0 = static_cast<std::int32_t>(slab) * LabelVolume::slab;
        const std::int32_t k1 = std::min(k0 + LabelVolume::slab, size[2]);
        for (const Strut& in_mm : struts) {
            const Strut strut{in_mm.from / voxel_size, in_mm.to / voxel_size};
            std::array<std::int32_t, 3> first, end;
            bool meets = true;
            for (int axis = 0; axis < 3; ++axis) {
                const double low = std::min(strut.from[axis], strut.to[axis]) - reach;
                const double high = std::max(strut.from[axis], strut.to[axis]) + reach;
                const double from = axis == 2 ? k0 : 0, to = axis == 2 ? k1 : size[axis];
                first[axis] = static_cast<std::int32_t>(std::clamp(std::ceil(low - 0.5), from, to));
                end[axis] = static_cast<std::int32_t>(std::clamp(std::floor(high - 0.5) + 1, from, to));
                meets = meets && first[axis] < end[axis];
            }
            if (!meets) continue;
            for (std::int32_t z = first[2]; z < end[2]; ++z)
                for (std::int32_t y = first[1]; y < end[1]; ++y) {
                    float* const row = distances.data() + z * page + std::int64_t{y} * size[0];
                    for (std::int32_t x = first[0]; x < end[0]; ++x)
                        row[x] = std::min(row[x],
                                          static_cast<float>(square_distance(Vec3(x + 0.5, y + 0.5, z + 0.5), strut)));
                }
        }
        const std::scoped_lock lock(one_at_a_time);
        progress->update(++done);
    });
    return distances;
}

}  // namespace

std::vector<Strut> foam_struts(const Vec3& edges, double cell, double irregularity, Random& random,
                               Reporter& reporter) {
    std::vector<Vec3> seeds;
    std::array<std::int64_t, 3> count;
    constexpr std::int64_t margin = 3;  // cubes around the box
    for (int axis = 0; axis < 3; ++axis) count[axis] = std::llround(std::ceil(edges[axis] / cell - 1e-9));
    const double neighbour = std::sqrt(3.0) / 2 * cell;
    // Faces of the box in planes of symmetry would cut off many equal bits of struts at once.
    const Vec3 offset(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    for (std::int64_t z = -margin; z < count[2] + margin; ++z)
        for (std::int64_t y = -margin; y < count[1] + margin; ++y)
            for (std::int64_t x = -margin; x < count[0] + margin; ++x)
                for (const double half : {0.25, 0.75}) {
                    const Vec3 shift = random.direction() * neighbour / 2 * std::cbrt(random.uniform(0, 1));
                    seeds.push_back(cell * (Vec3(x, y, z) + offset + Vec3::Constant(half)) + irregularity * shift);
                }

    struct KeyedStrut {
        std::array<std::int64_t, 3> middle;  // on a fine grid: each edge is met in three cells, twice in each
        Strut strut;
    };
    std::vector<KeyedStrut> found;
    std::vector<std::pair<double, Vec3>> neighbours;
    const auto progress = reporter.progress("cells", static_cast<double>(seeds.size()));
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        // A cell whose seed is this far outside cannot reach into the box.
        if ((seeds[i].array() < -1.5 * cell).any() || (seeds[i].array() > (edges.array() + 1.5 * cell)).any()) continue;
        neighbours.clear();
        for (std::size_t j = 0; j < seeds.size(); ++j) {
            const Vec3 line = seeds[j] - seeds[i];
            if (j != i && line.squaredNorm() < 9 * cell * cell) neighbours.emplace_back(line.norm(), line);
        }
        std::sort(neighbours.begin(), neighbours.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        Polyhedron faces = cube(1.5 * cell);
        for (const auto& [distance, line] : neighbours) {
            if (distance / 2 > farthest_corner(faces)) break;
            clip(faces, line, line.squaredNorm() / 2, 1e-9 * cell);
        }
        for (const auto& face : faces)
            for (std::size_t k = 0; k < face.size(); ++k) {
                const Strut strut{seeds[i] + face[k], seeds[i] + face[(k + 1) % face.size()]};
                if ((strut.to - strut.from).norm() < 1e-4 * cell) continue;
                const Vec3 middle = (strut.from + strut.to) / 2;
                if ((middle.array() < -cell).any() || (middle.array() > edges.array() + cell).any()) continue;
                const Vec3 key = middle / (1e-6 * cell);
                found.push_back({{std::llround(key[0]), std::llround(key[1]), std::llround(key[2])}, strut});
            }
        progress->update(static_cast<double>(i + 1));
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.middle < b.middle; });
    std::vector<Strut> struts;
    for (std::size_t i = 0; i < found.size(); ++i)
        if (i == 0 || found[i].middle != found[i - 1].middle) struts.push_back(found[i].strut);
    return struts;
}

Foam draw_foam(const std::vector<Strut>& struts, VoxelIndex size, double voxel_size, double relative_density,
               int threads, Reporter& reporter) {
    const std::int64_t page = std::int64_t{size[0]} * size[1], voxels = page * size[2];
    const auto wanted = static_cast<std::int64_t>(std::llround(relative_density * static_cast<double>(voxels)));

    // Struts as separate cylinders give a first radius; they overlap at the nodes, so the true one is larger.
    double length = 0;
    for (const Strut& strut : struts) length += (strut.to - strut.from).norm() / voxel_size;
    double reach = 2 + 1.5 * std::sqrt(relative_density * static_cast<double>(voxels) / (std::numbers::pi * length));
    std::vector<float> distances, sorted;
    for (;;) {
        distances = square_distances(struts, size, voxel_size, reach, threads, reporter);
        sorted.clear();
        const auto limit = static_cast<float>(reach * reach);
        std::copy_if(distances.begin(), distances.end(), std::back_inserter(sorted),
                     [&](float d) { return d < limit; });
        if (static_cast<double>(sorted.size()) > 1.1 * static_cast<double>(wanted)) break;
        reach *= 1.3;
    }

    Foam foam{LabelVolume(size, Vec3::Constant(voxel_size)), 0, 0, 0};
    std::vector<std::int32_t> labels;
    // Draws the solid whose radius is the rank-th smallest distance, without the bits that the faces cut off.
    const auto draw = [&](std::int64_t rank) {
        std::nth_element(sorted.begin(), sorted.begin() + (rank - 1), sorted.end());
        const float square = sorted[rank - 1];
        foam.strut_radius = std::sqrt(static_cast<double>(square)) * voxel_size;
        for (std::int32_t k = 0; k < size[2]; k += LabelVolume::slab) {
            const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
            labels.resize(page * count);
            for (std::int64_t i = 0; i < page * count; ++i) labels[i] = distances[k * page + i] <= square;
            foam.volume.set_slices(k, count, labels);
        }
        const Components components =
            connected_components(foam.volume, {1}, Joining::any_label, Connectivity::faces, reporter);
        const auto largest = std::max_element(components.voxels.begin(), components.voxels.end());
        const auto number = static_cast<std::int32_t>(largest - components.voxels.begin() + 1);
        foam.solid_voxels = *largest;
        foam.removed_voxels = std::reduce(components.voxels.begin(), components.voxels.end()) - *largest;
        if (static_cast<double>(foam.removed_voxels) > 0.1 * static_cast<double>(foam.solid_voxels))
            throw InvalidInput(
                fmt::format("struts of {:.2g} voxels radius do not hold together; ask for a higher density, or for "
                            "fewer and so thicker ones (--cells, --fibres)",
                            foam.strut_radius / voxel_size));
        for (std::int32_t k = 0; foam.removed_voxels > 0 && k < size[2]; k += LabelVolume::slab) {
            const std::int32_t count = std::min(LabelVolume::slab, size[2] - k);
            components.number.slices(k, count, labels);
            for (std::int32_t& label : labels) label = label == number;
            foam.volume.set_slices(k, count, labels);
        }
    };

    // A larger radius never makes the largest component smaller, so the rank can be bisected; a step by what is missing
    // usually hits at once.
    const auto tolerance = std::max<std::int64_t>(1, voxels / 10000);
    std::int64_t low = 0, high = static_cast<std::int64_t>(sorted.size()), rank = wanted;
    for (;;) {
        draw(rank);
        const std::int64_t missing = wanted - foam.solid_voxels;
        if (std::abs(missing) <= tolerance) return foam;
        (missing > 0 ? low : high) = rank;
        if (high - low <= 1) break;
        rank = rank + missing > low && rank + missing < high ? rank + missing : low + (high - low) / 2;
    }
    if (std::abs(static_cast<double>(foam.solid_voxels - wanted)) > 0.002 * static_cast<double>(voxels))
        throw InvalidInput(
            fmt::format("no radius of the struts gives a relative density of {:g} within 0.002 (nearest: {:.4f}); "
                        "use more voxels or another --random-seed",
                        relative_density, static_cast<double>(foam.solid_voxels) / static_cast<double>(voxels)));
    return foam;
}

}  // namespace tomodem::phantom
