#include "tools/phantom/spheres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::phantom {
namespace {

/// A sphere around a grain, for the first look.
Sphere bounds(const Grain& grain) {
    Sphere around{grain_centre(grain), 0};
    for (const Sphere& sphere : grain.spheres)
        around.radius = std::max(around.radius, (sphere.centre - around.centre).norm() + sphere.radius);
    return around;
}

void move(Grain& grain, const Vec3& by) {
    for (Sphere& sphere : grain.spheres) sphere.centre += by;
}

/// Smallest distance between the surfaces; negative when they overlap. `between` becomes the vector from a to b there.
double surface_distance(const Grain& a, const Grain& b, Vec3& between) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Sphere& one : a.spheres)
        for (const Sphere& other : b.spheres) {
            const Vec3 line = other.centre - one.centre;
            const double distance = line.norm() - one.radius - other.radius;
            if (distance < smallest) {
                smallest = distance;
                between = line;
            }
        }
    return smallest;
}

/// Pushes a grain back into the box; true when it stuck out.
bool push_inside(Grain& grain, const Vec3& edges, double gap) {
    Vec3 step = Vec3::Zero();
    for (const Sphere& sphere : grain.spheres)
        for (int axis = 0; axis < 3; ++axis) {
            const double low = gap + sphere.radius - sphere.centre[axis];
            const double high = edges[axis] - gap - sphere.radius - sphere.centre[axis];
            if (low > 0 && high < 0) continue;
            if (low > step[axis]) step[axis] = low;
            if (high < step[axis]) step[axis] = high;
        }
    move(grain, step);
    return !step.isZero(0);
}

/// Grains by the cells of a grid, so that only neighbours are compared.
class Neighbours {
 public:
    Neighbours(const Vec3& edges, double cell) {
        for (int axis = 0; axis < 3; ++axis) {
            count_[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(edges[axis] / cell), 1, 200);
            width_[axis] = edges[axis] / static_cast<double>(count_[axis]);
        }
        cells_.resize(count_[0] * count_[1] * count_[2]);
    }
    void clear() {
        for (auto& cell : cells_) cell.clear();
    }
    void add(std::size_t grain, const Vec3& centre) {
        const auto at = cell_of(centre);
        cells_[(at[2] * count_[1] + at[1]) * count_[0] + at[0]].push_back(grain);
    }
    /// Calls visit(i) for the grains in the cells around; stops when it returns false, and returns that.
    template <class Visit>
    bool all_of_neighbours(const Vec3& centre, const Visit& visit) const {
        const auto at = cell_of(centre);
        for (auto z = std::max<std::int64_t>(0, at[2] - 1); z < std::min(count_[2], at[2] + 2); ++z)
            for (auto y = std::max<std::int64_t>(0, at[1] - 1); y < std::min(count_[1], at[1] + 2); ++y)
                for (auto x = std::max<std::int64_t>(0, at[0] - 1); x < std::min(count_[0], at[0] + 2); ++x)
                    for (const std::size_t i : cells_[(z * count_[1] + y) * count_[0] + x])
                        if (!visit(i)) return false;
        return true;
    }

 private:
    std::array<std::int64_t, 3> cell_of(const Vec3& centre) const {
        std::array<std::int64_t, 3> at;
        for (int axis = 0; axis < 3; ++axis)
            at[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(centre[axis] / width_[axis])), 0,
                                                count_[axis] - 1);
        return at;
    }
    std::array<std::int64_t, 3> count_;
    Vec3 width_;
    std::vector<std::vector<std::size_t>> cells_;
};

void place_at_random(Grain& grain, const Sphere& around, const Vec3& edges, double gap, Random& random) {
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
        const double margin = std::min(around.radius + gap, edges[axis] / 2);
        place[axis] = random.uniform(margin, edges[axis] - margin);
    }
    move(grain, place - bounds(grain).centre);
}

/// @return the pairs of neighbours that are still too close, after pushing each apart half of what is missing
std::size_t push_apart(std::vector<Grain>& grains, const Vec3& edges, double gap, Neighbours& neighbours) {
    neighbours.clear();
    for (std::size_t i = 0; i < grains.size(); ++i) neighbours.add(i, grain_centre(grains[i]));
    std::vector<Vec3> step(grains.size(), Vec3::Zero());
    std::size_t close = 0;
    for (std::size_t i = 0; i < grains.size(); ++i)
        neighbours.all_of_neighbours(grain_centre(grains[i]), [&](std::size_t j) {
            if (j <= i) return true;
            Vec3 between = Vec3::Zero();
            const double missing = gap - surface_distance(grains[i], grains[j], between);
            if (missing <= 0) return true;
            ++close;
            const double length = between.norm();
            const Vec3 direction = length > 0 ? Vec3(between / length) : Vec3::UnitX();
            // A little more than half, or the last overlaps would take forever to go.
            step[i] -= 0.55 * missing * direction;
            step[j] += 0.55 * missing * direction;
            return true;
        });
    for (std::size_t i = 0; i < grains.size(); ++i) {
        move(grains[i], step[i]);
        if (push_inside(grains[i], edges, gap)) ++close;
    }
    return close;
}

}  // namespace

double Sphere::volume() const {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

double grain_volume(const Grain& grain) {
    if (grain.spheres.size() == 1) return grain.spheres[0].volume();
    Vec3 low = grain.spheres[0].centre, high = low;
    for (const Sphere& sphere : grain.spheres) {
        low = low.cwiseMin(sphere.centre - Vec3::Constant(sphere.radius));
        high = high.cwiseMax(sphere.centre + Vec3::Constant(sphere.radius));
    }
    // Along each column of a fine grid the union of the spheres' chords is exact.
    constexpr int columns = 200;
    const double dx = (high[0] - low[0]) / columns, dy = (high[1] - low[1]) / columns;
    double volume = 0;
    std::vector<std::pair<double, double>> chords;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < columns; ++j) {
            const double x = low[0] + (i + 0.5) * dx, y = low[1] + (j + 0.5) * dy;
            chords.clear();
            for (const Sphere& sphere : grain.spheres) {
                const double square = sphere.radius * sphere.radius - std::pow(x - sphere.centre[0], 2) -
                                      std::pow(y - sphere.centre[1], 2);
                if (square > 0)
                    chords.emplace_back(sphere.centre[2] - std::sqrt(square), sphere.centre[2] + std::sqrt(square));
            }
            std::sort(chords.begin(), chords.end());
            double end = -std::numeric_limits<double>::infinity();
            for (const auto& [from, to] : chords) {
                volume += std::max(0.0, to - std::max(from, end)) * dx * dy;
                end = std::max(end, to);
            }
        }
    return volume;
}

Vec3 grain_centre(const Grain& grain) {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (const Sphere& sphere : grain.spheres) {
        sum += sphere.volume() * sphere.centre;
        weight += sphere.volume();
    }
    return sum / weight;
}

double Random::uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
}

double Random::normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));  // Box-Muller
    return radius * std::cos(uniform(0, 2 * std::numbers::pi));
}

Vec3 Random::direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi), across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
}

std::vector<Grain> place_without_overlap(std::vector<Grain> grains, const Vec3& edges, double gap, Random& random,
                                         Reporter& reporter) {
    if (grains.empty()) return grains;
    double largest = 0;
    for (const Grain& grain : grains) largest = std::max(largest, bounds(grain).radius);
    if (2 * (largest + gap) > edges.minCoeff())
        throw InvalidInput(
            fmt::format("a grain of {:.4g} mm across does not fit into a box of {:.4g} mm; make the volume "
                        "larger or the grains smaller",
                        2 * largest, edges.minCoeff()));

    std::vector<std::size_t> order(grains.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return bounds(grains[a]).radius > bounds(grains[b]).radius; });
    Neighbours neighbours(edges, 2 * largest + gap);
    bool all_placed = true;
    const auto progress = reporter.progress("placing", static_cast<double>(grains.size()));
    for (std::size_t placed = 0; placed < order.size(); ++placed) {
        Grain& grain = grains[order[placed]];
        const Sphere around = bounds(grain);
        bool found = false;
        constexpr int trials = 3000;
        for (int trial = 0; trial < trials && !found && all_placed; ++trial) {
            place_at_random(grain, around, edges, gap, random);
            found = neighbours.all_of_neighbours(grain_centre(grain), [&](std::size_t other) {
                Vec3 between = Vec3::Zero();
                return surface_distance(grain, grains[other], between) >= gap;
            });
        }
        if (!found) {
            place_at_random(grain, around, edges, gap, random);
            all_placed = false;
        }
        neighbours.add(order[placed], grain_centre(grain));
        progress->update(static_cast<double>(placed + 1));
    }
    if (all_placed) return grains;

    constexpr int max_steps = 4000;
    // Aim at a slightly larger gap: what is left after the last push is then still enough.
    const double aim = gap + 1e-3 * largest;
    for (int step = 0; step < max_steps; ++step) {
        push_apart(grains, edges, aim, neighbours);
        bool enough = true;
        neighbours.clear();
        for (std::size_t i = 0; i < grains.size(); ++i) neighbours.add(i, grain_centre(grains[i]));
        for (std::size_t i = 0; i < grains.size() && enough; ++i) {
            Grain pushed = grains[i];
            enough = !push_inside(pushed, edges, gap) &&
                     neighbours.all_of_neighbours(grain_centre(grains[i]), [&](std::size_t j) {
                         Vec3 between = Vec3::Zero();
                         return j <= i || surface_distance(grains[i], grains[j], between) >= gap;
                     });
        }
        if (enough) return grains;
    }
    throw InvalidInput(
        fmt::format("{} grains with gaps of {:.3g} mm do not fit into the volume without overlap; ask for a "
                    "smaller fraction or gap, or more overlap",
                    grains.size(), gap));
}

Raster rasterise(const std::vector<Grain>& grains, VoxelIndex size, double voxel_size, std::int32_t label,
                 std::int32_t background, int threads, Reporter& reporter) {
    Raster raster{LabelVolume(size, Vec3::Constant(voxel_size)), std::vector<std::int64_t>(grains.size(), 0)};
    raster.volume.use_threads(threads);
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::int32_t> labels;
    const auto progress = reporter.progress("drawing", size[2]);
    for (std::int32_t k0 = 0; k0 < size[2]; k0 += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k0);
        labels.assign(page * count, background);
        for (std::size_t i = 0; i < grains.size(); ++i)
            for (const Sphere& sphere : grains[i].spheres) {
                const Vec3 centre = sphere.centre / voxel_size;  // in voxels from here on
                const double radius = sphere.radius / voxel_size;
                if (centre[2] + radius < k0 || centre[2] - radius > k0 + count) continue;
                for (std::int32_t z = 0; z < count; ++z) {
                    const double dz = k0 + z + 0.5 - centre[2];
                    const double disc = radius * radius - dz * dz;
                    if (disc < 0) continue;
                    const auto first_row =
                        static_cast<std::int32_t>(std::max(0.0, std::ceil(centre[1] - std::sqrt(disc) - 0.5)));
                    for (std::int32_t y = first_row; y < size[1]; ++y) {
                        const double dy = y + 0.5 - centre[1];
                        const double chord = disc - dy * dy;
                        if (chord < 0) {
                            if (dy > 0) break;
                            continue;
                        }
                        const double half = std::sqrt(chord);
                        const auto from = static_cast<std::int32_t>(std::max(0.0, std::ceil(centre[0] - half - 0.5)));
                        const auto to =
                            static_cast<std::int32_t>(std::min(size[0] - 1.0, std::floor(centre[0] + half - 0.5)));
                        std::int32_t* const row = labels.data() + z * page + std::int64_t{y} * size[0];
                        for (std::int32_t x = from; x <= to; ++x)
                            if (row[x] != label) {
                                row[x] = label;
                                ++raster.voxels[i];
                            }
                    }
                }
            }
        raster.volume.set_slices(k0, count, labels);
        progress->update(k0 + count);
    }
    return raster;
}

Raster rasterise_numbers(const std::vector<Grain>& grains, VoxelIndex size, double voxel_size, Reporter& reporter) {
    Raster raster{LabelVolume(size, Vec3::Constant(voxel_size)), std::vector<std::int64_t>(grains.size(), 0)};
    const std::int64_t page = std::int64_t{size[0]} * size[1];
    std::vector<std::int32_t> numbers;
    std::vector<double>
        power;  // distance squared to the centre, minus the radius squared, of the grain that has the voxel
    const auto progress = reporter.progress("drawing", size[2]);
    for (std::int32_t k0 = 0; k0 < size[2]; k0 += LabelVolume::slab) {
        const std::int32_t count = std::min(LabelVolume::slab, size[2] - k0);
        numbers.assign(page * count, 0);
        power.assign(page * count, 0.0);
        for (std::size_t i = 0; i < grains.size(); ++i) {
            const Sphere& sphere = grains[i].spheres[0];
            const Vec3 centre = sphere.centre / voxel_size;  // in voxels from here on
            const double radius = sphere.radius / voxel_size;
            const auto first = [&](int axis, std::int32_t start) {
                return std::max(start, static_cast<std::int32_t>(std::floor(centre[axis] - radius)));
            };
            const auto end = [&](int axis, std::int32_t stop) {
                return std::min(stop, static_cast<std::int32_t>(std::ceil(centre[axis] + radius)) + 1);
            };
            for (std::int32_t z = first(2, k0); z < end(2, k0 + count); ++z)
                for (std::int32_t y = first(1, 0); y < end(1, size[1]); ++y)
                    for (std::int32_t x = first(0, 0); x < end(0, size[0]); ++x) {
                        const double here = (Vec3(x + 0.5, y + 0.5, z + 0.5) - centre).squaredNorm() - radius * radius;
                        const std::int64_t at = (z - k0) * page + std::int64_t{y} * size[0] + x;
                        if (here > power[at]) continue;
                        power[at] = here;
                        numbers[at] = static_cast<std::int32_t>(i + 1);
                    }
        }
        for (const std::int32_t number : numbers)
            if (number > 0) ++raster.voxels[number - 1];
        raster.volume.set_slices(k0, count, numbers);
        progress->update(k0 + count);
    }
    return raster;
}

}  // namespace tomodem::phantom
