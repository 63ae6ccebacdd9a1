#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tomodem {

using Vec3 = Eigen::Vector3d;

/// Axis-parallel box in world coordinates [mm].
struct Box {
    Vec3 origin = Vec3::Zero();
    Vec3 edges = Vec3::Zero();
    std::array<bool, 3> periodic{false, false, false};
    double volume() const { return edges.prod(); }
};

/// Spheres with labels, equal unless they have radii of their own. All lengths in mm, world coordinates (those of the
/// tomography where there was one).
///
/// Arrays have one entry a particle, sorted by id; `object` is empty where there are no objects, `radius` where
/// all spheres are equal.
struct Packing {
    Box box;                   ///< the region that was filled; edges[0] * edges[1] is the initial section
    double seed_radius = 0.0;  ///< r_s [mm]; of spheres with radii of their own the mean in the brick they come from
    std::vector<Vec3> position;
    std::vector<std::int32_t> species;  ///< label of the phase in the image
    std::vector<std::int64_t> id;       ///< unique, from 1
    std::vector<std::int32_t> object;   ///< 0: belongs to no object of its own
    bool relaxed = false;               ///< the free sample is at rest under its law
    double brick_density = 0.0;         ///< D of the packing that the sample was cut from; 0: not known
    std::vector<double> radius{};       ///< [mm]
    /// Other quantities of each particle by their name, such as a temperature from another volume; the solver ignores
    /// them.
    std::map<std::string, std::vector<double>> property{};
    std::map<std::int32_t, std::string> label_names{};  ///< what the labels were called in the image, where they were

    std::size_t size() const { return position.size(); }
    double radius_of(std::size_t particle) const { return radius.empty() ? seed_radius : radius[particle]; }
    /// D: volume of the spheres over that of the box, N pi d^3 / (6 V) for equal ones (method: control numbers).
    double density() const;
};

/// A quantity that every frame of a run holds of every particle, besides its position: /particles/all/NAME.
struct ParticleField {
    std::string name, unit;  ///< an empty unit: a pure number
    int components = 3;
    std::vector<std::pair<std::string, double>> attributes{};  ///< of its group
};

}  // namespace tomodem
