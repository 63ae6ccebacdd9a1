#pragma once
#include <numbers>

namespace tomodem::law {

/// Constants of BILIN for one kind of pair (two particles, or a particle and a wall).
struct Bilin {
    double seed_distance;         ///< 2 r_s between particles, r_s at a wall [mm]
    double crown_distance;        ///< 2 r_c between particles, r_c at a wall [mm]
    double repulsive_stiffness;   ///< k_rep [uN/mm]
    double attractive_stiffness;  ///< k_att [uN/mm]
};

/// Signed normal force [uN], repulsion positive (thesis section 4.3; method: pair laws).
///
/// Repulsion inside the seed whatever the rate; in the crown an attraction that acts only while the pair separates.
///
/// @param distance  between the centres, or from the centre to the wall [mm]
/// @param rate      its time derivative [mm/s], positive when separating
constexpr double bilin_force(const Bilin& law, double distance, double rate) {
    if (distance <= law.seed_distance) return law.repulsive_stiffness * (law.seed_distance - distance);
    if (distance <= law.crown_distance && rate > 0) return law.attractive_stiffness * (law.seed_distance - distance);
    return 0;
}

/// Mass [g] of a particle whose natural period is t0 = 2 pi sqrt(m / k_rep).
constexpr double mass_for_period(double repulsive_stiffness, double natural_period) {
    return repulsive_stiffness * natural_period * natural_period / (4 * std::numbers::pi * std::numbers::pi);
}

/// Constants of a pair of two materials: the averages of both (method: two materials).
constexpr Bilin mixed(const Bilin& a, const Bilin& b) {
    return {(a.seed_distance + b.seed_distance) / 2, (a.crown_distance + b.crown_distance) / 2,
            (a.repulsive_stiffness + b.repulsive_stiffness) / 2, (a.attractive_stiffness + b.attractive_stiffness) / 2};
}

}  // namespace tomodem::law
