#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem::vol2pack {

/// The brick repeated through space at the scale of a sample, shifted and rotated, as far as a box goes.
///
/// The lowest corner of the brick's first copy lies at that of the box. A random seed other than 0 shifts the brick by
/// a random vector and rotates it by a random rotation: a packing is the same in all directions, a tiling of it has
/// no end, so any rotation of it fills the box as well, whatever the edges of the brick are. (The 24 rotations of a
/// cube would give few samples, and only bricks of three equal edges would keep their periods.) Along an axis that is
/// not periodic the brick is not repeated: the box must fit into it, the shift stays within it, and the only rotation
/// left is the one about that axis; with two such axes, none.
///
/// A *place* is one particle of one copy, in the box, in the margin around it or beyond. Copies are numbered x fastest,
/// the places of a copy follow one another in the order of the brick.
class Tiling {
 public:
    /// @throws InvalidInput if the brick is empty, or not periodic along an axis where the box is longer, or if the box
    ///         would hold more than `max_particles`
    Tiling(const Packing& brick, double seed_radius, const Box& box, std::uint64_t random_seed,
           std::int64_t max_particles = 50'000'000);

    std::int64_t tiles() const { return static_cast<std::int64_t>(tile_.size()); }
    std::int64_t in_brick() const { return static_cast<std::int64_t>(position_.size()); }
    std::int64_t places() const { return tiles() * in_brick(); }
    double seed_radius() const { return seed_radius_; }
    double density() const { return density_; }  ///< D of the brick
    /// The brick has spheres with radii of their own.
    bool has_radii() const { return !radius_.empty(); }
    double radius(std::int64_t place) const { return radius_[place % in_brick()]; }
    const Box& box() const { return box_; }

    /// From the lowest corner of the box [mm].
    Vec3 from_corner(std::int64_t place) const;
    bool in_box(const Vec3& from_corner) const;
    /// Also within a needle of the box.
    bool in_margin(const Vec3& from_corner) const;
    /// A point of the margin seen in the faces of the box.
    Vec3 mirrored(const Vec3& from_corner) const;
    /// The tile that lies `offset` tiles further along the edges of the brick; -1: not one of these.
    std::int64_t neighbour(std::int64_t tile, const std::array<std::int32_t, 3>& offset) const;

    /// Two particles of the brick that are close to each other; the second is in the copy `offset` tiles further.
    struct Needle {
        std::array<std::int32_t, 3> offset;
        std::int32_t from, to;
        Vec3 along;  ///< from the first to the second, as they lie in the box [mm]
    };
    /// Each pair within longest_needle() once, ordered by offset: 5 to 6 a particle.
    std::vector<Needle> needles() const;
    /// 1.4 times the cube root of a particle's share of the volume: the first shell of neighbours, up to 1.3 diameters
    /// of a seed in a dense packing [mm].
    double longest_needle() const { return longest_needle_; }

 private:
    Box box_;
    double seed_radius_, density_, longest_needle_;
    Vec3 edges_;
    std::array<bool, 3> periodic_;
    std::vector<Vec3> position_;  // in [0, edge) along the periodic axes
    std::vector<double> radius_;  // mm, as they are in the box; empty where all are that of a seed
    Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
    Vec3 shift_ = Vec3::Zero();  // of the corner of the brick, along the axes that are not periodic
    std::array<std::int32_t, 3> first_{}, count_{};
    std::vector<std::array<std::int32_t, 3>> tile_;  // those that meet the box and its margin
    std::vector<std::int32_t> number_of_tile_;       // of all from first_ on, -1: not one of these
};

}  // namespace tomodem::vol2pack
