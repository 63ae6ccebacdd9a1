#include "tools/vol2pack/tiling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/error.hpp"

namespace tomodem::vol2pack {
namespace {

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Uniform over all rotations: a random point of the unit sphere in four dimensions is a quaternion.
Eigen::Matrix3d random_rotation(std::mt19937_64& random) {
    for (;;) {
        Eigen::Vector4d point;
        for (double& component : point) component = 2 * uniform(random) - 1;
        const double length = point.norm();
        if (length > 1 || length < 0.1) continue;
        point /= length;
        return Eigen::Quaterniond(point[0], point[1], point[2], point[3]).toRotationMatrix();
    }
}

Eigen::Matrix3d random_rotation_about(int axis, std::mt19937_64& random) {
    for (;;) {
        const double x = 2 * uniform(random) - 1, y = 2 * uniform(random) - 1, length = std::hypot(x, y);
        if (length > 1 || length < 0.1) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
        rotation(u, u) = rotation(v, v) = x / length;
        rotation(u, v) = -y / length;
        rotation(v, u) = y / length;
        return rotation;
    }
}

}  // namespace

Tiling::Tiling(const Packing& brick, double seed_radius, const Box& box, std::uint64_t random_seed,
               std::int64_t max_particles)
    : box_(box), seed_radius_(seed_radius), periodic_(brick.box.periodic) {
    if (!(seed_radius > 0)) throw InvalidInput("the seed radius of a sample must be more than 0");
    if (brick.size() == 0 || !(brick.seed_radius > 0) || !(brick.box.volume() > 0))
        throw InvalidInput("the brick has no particles, no seed radius or no volume; make one with packgen");
    constexpr double loosest = 0.4;  // packgen's bricks have 0.5 and more
    density_ = brick.density();
    if (density_ < loosest)
        throw InvalidInput(
            fmt::format("the brick fills only {:.3g} of its box with particles: it is a sample or a frame of "
                        "a run; give a dense packing from packgen",
                        density_));
    edges_ = brick.box.edges * (seed_radius / brick.seed_radius);
    for (const double radius : brick.radius) radius_.push_back(radius * (seed_radius / brick.seed_radius));
    longest_needle_ = 1.4 * std::cbrt(edges_.prod() / static_cast<double>(brick.size()));
    const double expected = static_cast<double>(brick.size()) * (box.edges.prod() / edges_.prod());
    if (expected > static_cast<double>(max_particles))
        throw InvalidInput(
            fmt::format("the image would be filled with about {:.3g} particles, more than the {} allowed; "
                        "use more pixels per seed, or allow more",
                        expected, max_particles));
    int open_axes = 0, open_axis = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (periodic_[axis]) continue;
        ++open_axes;
        open_axis = axis;
        if (box.edges[axis] > edges_[axis] * (1 + 1e-9))
            throw InvalidInput(fmt::format(
                "the brick is not periodic along {0}, so it cannot be repeated there, and at this scale it is {1:.4g} "
                "mm "
                "long where the image has {2:.4g} mm; give a longer brick, or one that is periodic along {0}",
                "xyz"[axis], edges_[axis], box.edges[axis]));
    }

    Vec3 fraction_shift = Vec3::Zero();
    if (random_seed != 0) {
        std::mt19937_64 random(random_seed);
        for (int axis = 0; axis < 3; ++axis) {
            const double part = uniform(random);
            if (periodic_[axis])
                fraction_shift[axis] = part;
            else
                shift_[axis] = -part * std::max(0.0, edges_[axis] - box.edges[axis]);
        }
        if (open_axes == 0) rotation_ = random_rotation(random);
        if (open_axes == 1) rotation_ = random_rotation_about(open_axis, random);
    }

    position_.reserve(brick.size());
    for (const Vec3& position : brick.position) {
        Vec3 fraction = (position - brick.box.origin).cwiseQuotient(brick.box.edges) + fraction_shift;
        if (!fraction.allFinite()) throw InvalidInput("the brick has a position that is not a number");
        for (int axis = 0; axis < 3; ++axis) {
            if (!periodic_[axis]) continue;
            fraction[axis] -= std::floor(fraction[axis]);
            if (fraction[axis] >= 1) fraction[axis] = 0;  // a negative number too small to change 1
        }
        position_.push_back(fraction.cwiseProduct(edges_));
    }

    // The tiles between the ends of the box and its margin, seen from the brick.
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 point;
        for (int axis = 0; axis < 3; ++axis)
            point[axis] = corner >> axis & 1 ? box.edges[axis] + longest_needle_ : -longest_needle_;
        const Vec3 seen = rotation_.transpose() * point;
        low = low.cwiseMin(seen);
        high = high.cwiseMax(seen);
    }
    for (int axis = 0; axis < 3; ++axis) {
        first_[axis] = periodic_[axis] ? static_cast<std::int32_t>(std::floor(low[axis] / edges_[axis])) : 0;
        const double end = periodic_[axis] ? std::ceil(high[axis] / edges_[axis]) : 1;
        count_[axis] = std::max(1, static_cast<std::int32_t>(end) - first_[axis]);
    }
    number_of_tile_.assign(std::size_t(count_[0]) * count_[1] * count_[2], -1);
    const Vec3 reach = rotation_.cwiseAbs() * edges_ / 2 + Vec3::Constant(longest_needle_);
    for (std::size_t i = 0; i < number_of_tile_.size(); ++i) {
        const std::array<std::int32_t, 3> tile{first_[0] + static_cast<std::int32_t>(i % count_[0]),
                                               first_[1] + static_cast<std::int32_t>(i / count_[0] % count_[1]),
                                               first_[2] + static_cast<std::int32_t>(i / count_[0] / count_[1])};
        const Vec3 middle =
            rotation_ * ((Vec3(tile[0], tile[1], tile[2]) + Vec3::Constant(0.5)).cwiseProduct(edges_)) + shift_;
        if (((middle + reach).array() < 0).any() || ((middle - reach).array() > box.edges.array()).any()) continue;
        number_of_tile_[i] = static_cast<std::int32_t>(tile_.size());
        tile_.push_back(tile);
    }
}

Vec3 Tiling::from_corner(std::int64_t place) const {
    const auto& index = tile_[place / in_brick()];
    return rotation_ * (Vec3(index[0], index[1], index[2]).cwiseProduct(edges_) + position_[place % in_brick()]) +
           shift_;
}

bool Tiling::in_box(const Vec3& from_corner) const {
    return (from_corner.array() >= 0).all() && (from_corner.array() < box_.edges.array()).all();
}

bool Tiling::in_margin(const Vec3& from_corner) const {
    return (from_corner.array() >= -longest_needle_).all() &&
           (from_corner.array() < box_.edges.array() + longest_needle_).all();
}

Vec3 Tiling::mirrored(const Vec3& from_corner) const {
    Vec3 folded;
    for (int axis = 0; axis < 3; ++axis) {
        const double edge = box_.edges[axis], distance = std::abs(std::remainder(from_corner[axis], 2 * edge));
        folded[axis] = std::min(distance, std::nextafter(edge, 0));
    }
    return folded;
}

std::int64_t Tiling::neighbour(std::int64_t tile, const std::array<std::int32_t, 3>& offset) const {
    std::int64_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const std::int32_t at = tile_[tile][axis] + offset[axis] - first_[axis];
        if (at < 0 || at >= count_[axis]) return -1;
        index = index * count_[axis] + at;
    }
    return number_of_tile_[index];
}

std::vector<Tiling::Needle> Tiling::needles() const {
    const double cutoff = longest_needle_;
    struct Image {
        Vec3 position;
        std::int32_t particle;
        std::array<std::int32_t, 3> offset;
    };
    std::vector<Image> images;
    std::array<std::int32_t, 3> copies;
    for (int axis = 0; axis < 3; ++axis)
        copies[axis] = periodic_[axis] ? static_cast<std::int32_t>(std::ceil(cutoff / edges_[axis])) : 0;
    for (std::int32_t i = 0; i < in_brick(); ++i)
        for (std::int32_t z = -copies[2]; z <= copies[2]; ++z)
            for (std::int32_t y = -copies[1]; y <= copies[1]; ++y)
                for (std::int32_t x = -copies[0]; x <= copies[0]; ++x) {
                    const Vec3 position = position_[i] + Vec3(x, y, z).cwiseProduct(edges_);
                    const bool near =
                        (position.array() > -cutoff).all() && (position.array() < edges_.array() + cutoff).all();
                    if (near || (x == 0 && y == 0 && z == 0)) images.push_back({position, i, {x, y, z}});
                }

    // Cells of the cutoff; what lies far outside (along an axis that is not periodic) is put into the outermost.
    std::array<std::int32_t, 3> cells;
    for (int axis = 0; axis < 3; ++axis)
        cells[axis] = std::clamp(static_cast<std::int32_t>((edges_[axis] + 2 * cutoff) / cutoff), 1, 512);
    const auto cell_of = [&](const Vec3& position) {
        std::array<std::int32_t, 3> cell;
        for (int axis = 0; axis < 3; ++axis) {
            const double at = (position[axis] + cutoff) / (edges_[axis] + 2 * cutoff) * cells[axis];
            cell[axis] = static_cast<std::int32_t>(std::clamp(at, 0.0, cells[axis] - 1.0));
        }
        return cell;
    };
    const auto number_of = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
        return (std::size_t(z) * cells[1] + y) * cells[0] + x;
    };
    std::vector<std::int32_t> start(std::size_t(cells[0]) * cells[1] * cells[2] + 1, 0), order(images.size());
    for (const Image& image : images) {
        const auto cell = cell_of(image.position);
        ++start[number_of(cell[0], cell[1], cell[2]) + 1];
    }
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<std::int32_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < images.size(); ++i) {
        const auto cell = cell_of(images[i].position);
        order[next[number_of(cell[0], cell[1], cell[2])]++] = static_cast<std::int32_t>(i);
    }

    std::vector<Needle> found;
    constexpr std::array<std::int32_t, 3> here{0, 0, 0};
    for (std::int32_t i = 0; i < in_brick(); ++i) {
        const auto cell = cell_of(position_[i]);
        for (std::int32_t z = std::max(0, cell[2] - 1); z <= std::min(cells[2] - 1, cell[2] + 1); ++z)
            for (std::int32_t y = std::max(0, cell[1] - 1); y <= std::min(cells[1] - 1, cell[1] + 1); ++y)
                for (std::int32_t x = std::max(0, cell[0] - 1); x <= std::min(cells[0] - 1, cell[0] + 1); ++x)
                    for (std::int32_t k = start[number_of(x, y, z)]; k < start[number_of(x, y, z) + 1]; ++k) {
                        const Image& image = images[order[k]];
                        if (image.offset < here || (image.offset == here && image.particle <= i)) continue;
                        const Vec3 along = image.position - position_[i];
                        const double length = along.norm();
                        if (length <= cutoff && length > 0)
                            found.push_back({image.offset, i, image.particle, rotation_ * along});
                    }
    }
    std::stable_sort(found.begin(), found.end(), [](const Needle& a, const Needle& b) { return a.offset < b.offset; });
    return found;
}

}  // namespace tomodem::vol2pack
