#pragma once
#include <algorithm>

#include "solver_plugin/norton/four.hpp"

/// What the passes over the pairs of law NORTON find of particles and pairs, and the forces of a pair from it
/// (docs/norton.md).
namespace tomodem::plugin {

/// What the positions alone make of a particle.
struct FlowFabric {
    Four inverse[3];  ///< rows of A*^-1 [1/mm^2]; fourths: pressure [uN], eta [Pa.s], strength [Pa]
    Four outward;     ///< n / sqrt(n^2 + n_0^2); the fourth is w, from 0 at a surface to 1

    float pressure() const { return inverse[0][3]; }
    float viscosity() const { return inverse[1][3]; }
    float strength() const { return inverse[2][3]; }
    float inside() const { return outward[3]; }
    /// Its part of the pressure [uN].
    /// @param per_strength  [mm^2]
    float background(float per_strength) const { return per_strength * strength() * inside(); }
};

/// Over the neighbours of a particle.
struct FlowSums {
    Four moment[3];  ///< rows of sum v r
    Four outward;    ///< change of n; the fourth: of rho
};

/// Of a particle with its velocity and those of its neighbours.
struct FlowState {
    Four traction[3];  ///< columns of T; fourths: pressure, eta, unused
    Four diagonal;     ///< of D
    Four off;          ///< 2 D_xy, 2 D_yz, 2 D_zx
    Four lateral;      ///< a_n p n / sqrt(n^2 + n_0^2)

    float viscosity() const { return traction[1][3]; }
};

/// The 3 x 3 block of a particle with itself: {xx, yy, zz, -}, {xy, yz, zx, -}.
struct FlowBlock {
    Four diagonal, off;

    /// Adds the answer `size` to a motion along a vector.
    TOMODEM_INLINE void add(float size, Four vector) {
        diagonal += size * vector * vector;
        off += size * vector * turned(vector);
    }
};

/// Of a pair, ready to be multiplied.
struct PairGeometry {
    Four apart, direction;  // the fourth of the direction is 1
    float distance, over_distance, closeness;

    TOMODEM_INLINE PairGeometry(Four row, float over_reach)
        : apart(row), distance(row[3]), over_distance(1 / row[3]), closeness(std::max(0.0F, 1 - row[3] * over_reach)) {
        direction = apart * over_distance;
    }
};

/// Of a pair, from the states of its particles.
/// @param damping  of what is not in the mean flow [uN.s/mm]
TOMODEM_INLINE Four pair_term(const PairGeometry& pair, Four speed, const FlowState& own, const FlowState& theirs,
                              float damping) {
    const Four mean = (own.diagonal + theirs.diagonal) * pair.direction * pair.direction +
                      (own.off + theirs.off) * pair.direction * turned(pair.direction);
    const float strange = sum_of_three(speed * pair.direction - 0.5F * pair.distance * mean);
    return -damping * strange * pair.direction;
}

/// @param weight  of the particle's own traction
TOMODEM_INLINE Four viscous_force(const PairGeometry& pair, Four speed, const FlowState& own, const FlowState& theirs,
                                  float damping, float weight) {
    const float other = 2 - weight;
    return pair_term(pair, speed, own, theirs, damping) -
           (weight * own.traction[0] + other * theirs.traction[0]) * pair.apart[0] -
           (weight * own.traction[1] + other * theirs.traction[1]) * pair.apart[1] -
           (weight * own.traction[2] + other * theirs.traction[2]) * pair.apart[2];
}

/// @param pressures  of both
/// @param lateral    difference of what is along their outward vectors
TOMODEM_INLINE Four pressure_force(const PairGeometry& pair, float pressures, Four lateral, float reach) {
    const float along = sum_of_three(lateral * pair.direction);
    const float across = -reach * pair.closeness * pair.closeness * pair.over_distance;
    const float radial = 2 * pair.closeness * pressures + (2 * pair.closeness - across) * along;
    return radial * pair.direction + across * lateral;
}

TOMODEM_INLINE Four pressure_force(const PairGeometry& pair, const FlowState& own, const FlowState& theirs,
                                   float reach) {
    return pressure_force(pair, own.traction[0][3] + theirs.traction[0][3], own.lateral - theirs.lateral, reach);
}

}  // namespace tomodem::plugin
