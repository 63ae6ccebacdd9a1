#pragma once
#include <limits>
#include <numbers>

namespace tomodem::law {

/// Constants of BILIN and TRILIN between two particles. BILIN is TRILIN without a bound on the attraction.
struct Pair {
    double seed_distance;                                             ///< 2 r_s [mm]
    double crown_distance;                                            ///< 2 r_c [mm]
    double repulsive_stiffness;                                       ///< k_rep [uN/mm]
    double attractive_stiffness;                                      ///< k_att [uN/mm]
    double max_attraction = std::numeric_limits<double>::infinity();  ///< f_att [uN]
};

/// The constants against a wall: r_s and r_c in the place of 2 r_s and 2 r_c.
struct Wall : Pair {
    bool only_when_separating = true;  ///< the attraction looks at the rate: BILIN's does, TRILIN's does not
};

/// Signed normal force [uN], repulsion positive (docs/method.md: pair laws).
///
/// Repulsion inside the seed whatever the rate; in the crown a bounded attraction that acts only while the pair
/// separates.
///
/// @param distance  between the centres [mm]
/// @param rate      its time derivative [mm/s], positive when separating
constexpr double pair_force(const Pair& law, double distance, double rate) {
    if (distance <= law.seed_distance) return law.repulsive_stiffness * (law.seed_distance - distance);
    if (distance > law.crown_distance || rate <= 0) return 0;
    const double pull = law.attractive_stiffness * (law.seed_distance - distance);
    return pull > -law.max_attraction ? pull : -law.max_attraction;
}

/// Signed normal force [uN] of a wall on a particle; `distance` is from the centre to the wall.
constexpr double wall_force(const Wall& law, double distance, double rate) {
    return pair_force(law, distance, law.only_when_separating ? rate : 1.0);
}

/// TRILIN's walls pull this much more than a particle does: less lets them slip off, more tears the sample.
inline constexpr double trilin_wall_attraction = 3.0;

/// A particle's law against a wall, from its law with a particle of its own kind.
constexpr Wall against_wall(const Pair& pair) {
    const bool bounded = pair.max_attraction < std::numeric_limits<double>::infinity();
    const double pull = bounded ? trilin_wall_attraction : 1.0;
    return {{pair.seed_distance / 2, pair.crown_distance / 2, pair.repulsive_stiffness,
             pull * pair.attractive_stiffness, pull * pair.max_attraction},
            !bounded};
}

/// Mass [g] of a particle whose natural period is t0 = 2 pi sqrt(m / k_rep).
constexpr double mass_for_period(double repulsive_stiffness, double natural_period) {
    return repulsive_stiffness * natural_period * natural_period / (4 * std::numbers::pi * std::numbers::pi);
}

/// Forces of a material whose stiffness has changed by a factor; lengths stay.
constexpr Pair scaled(Pair pair, double factor) {
    pair.repulsive_stiffness *= factor;
    pair.attractive_stiffness *= factor;
    pair.max_attraction *= factor;
    return pair;
}

/// Constants of a pair of two materials: the averages of both (docs/method.md: two materials).
constexpr Pair mixed(const Pair& a, const Pair& b) {
    return {(a.seed_distance + b.seed_distance) / 2, (a.crown_distance + b.crown_distance) / 2,
            (a.repulsive_stiffness + b.repulsive_stiffness) / 2, (a.attractive_stiffness + b.attractive_stiffness) / 2,
            (a.max_attraction + b.max_attraction) / 2};
}

}  // namespace tomodem::law
