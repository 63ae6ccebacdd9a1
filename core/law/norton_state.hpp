#pragma once
#include "core/law/norton_law.hpp"

/// The state of one particle (Real = double) or of several at once (Real = a vector of GCC's extension).
namespace tomodem::law {

template <class Real>
struct NortonMaterialOf {
    Real consistency, rate_sensitivity, strength;
};

/// As NortonSums.
template <class Real>
struct NortonSumsOf {
    Real moment[3][3], diagonal[3], off[3], outward[3], of_own[3], density;
};

/// As NortonState.
template <class Real>
struct NortonStateOf {
    Real traction[3][3], inverse[3][3], diagonal[3], off[3], lateral[3], pressure, viscosity, background, inside;
};

/// What is added to A [mm^2]: 0.131 d^2 / (1 + a^4), a = 3 det A / (sum of the principal 2 x 2 minors) [d^2]: nothing where
/// a particle has its neighbours, and in flat or lone places as much as keeps A's inverse finite.
template <class Real>
[[gnu::always_inline]] inline void norton_fabric_floor(double d, const Real* diagonal, const Real* off, Real& floor) {
    const Real minors[3] = {diagonal[1] * diagonal[2] - off[1] * off[1], diagonal[0] * diagonal[2] - off[2] * off[2],
                            diagonal[0] * diagonal[1] - off[0] * off[0]};
    const Real determinant = diagonal[0] * minors[0] + off[0] * (off[1] * off[2] - off[0] * diagonal[2]) +
                             off[2] * (off[0] * off[1] - diagonal[1] * off[2]);
    const Real a = 3.0 / (d * d) * determinant / (minors[0] + minors[1] + minors[2] + 1e-9 * d * d * d * d);
    floor = NortonConstants::fabric_floor * d * d / (1.0 + a * a * a * a);
}

/// @param raise  (base above 0, exponent): raises the base
/// @param root   replaces a square by its root
template <class Real, class Raise, class Root>
[[gnu::always_inline]] inline void norton_state(const Norton& law, const NortonMaterialOf<Real>& material,
                                                const NortonSumsOf<Real>& sums, Raise raise, Root root,
                                                NortonStateOf<Real>& state) {
    using C = NortonConstants;
    const double d = law.seed_diameter;
    Real floor;
    norton_fabric_floor(d, sums.diagonal, sums.off, floor);
    const Real xx = sums.diagonal[0] + floor, yy = sums.diagonal[1] + floor, zz = sums.diagonal[2] + floor;
    const Real xy = sums.off[0], yz = sums.off[1], zx = sums.off[2];
    // A is symmetric and, with the floor, positive.
    const Real cofactor[6] = {yy * zz - yz * yz, xx * zz - zx * zx, xx * yy - xy * xy,
                              yz * zx - xy * zz, xy * zx - xx * yz, xy * yz - yy * zx};
    const Real over = 1.0 / (xx * cofactor[0] + xy * cofactor[3] + zx * cofactor[5]);
    const Real inverse[3][3] = {{cofactor[0] * over, cofactor[3] * over, cofactor[5] * over},
                                {cofactor[3] * over, cofactor[1] * over, cofactor[4] * over},
                                {cofactor[5] * over, cofactor[4] * over, cofactor[2] * over}};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) state.inverse[a][b] = inverse[a][b];
    Real gradient[3][3];
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            gradient[a][b] = sums.moment[a][0] * inverse[0][b] + sums.moment[a][1] * inverse[1][b] +
                             sums.moment[a][2] * inverse[2][b];
    const Real growth = gradient[0][0] + gradient[1][1] + gradient[2][2];
    Real squares{};
    for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3;
        state.diagonal[c] = gradient[c][c];
        state.off[c] = gradient[c][next] + gradient[next][c];
        const Real deviation = gradient[c][c] - growth / 3.0;
        squares += deviation * deviation + 0.5 * state.off[c] * state.off[c];
    }
    Real squared_rate = 2.0 / 3.0 * squares + law.min_rate * law.min_rate;
    if (law.at_rest) squared_rate = squared_rate * 0.0 + law.flow_rate * law.flow_rate;
    const Real exponent = 0.5 * (material.rate_sensitivity - 1.0);
    raise(squared_rate, exponent);
    state.viscosity = material.consistency * squared_rate;

    const Real shear = 2.0 / 3.0 * state.viscosity;
    const Real mean = (C::bulk_viscosity * state.viscosity - shear / 3.0) * growth;
    const Real xy_stress = 0.5 * shear * state.off[0], yz_stress = 0.5 * shear * state.off[1],
               zx_stress = 0.5 * shear * state.off[2];
    const Real stress[3][3] = {{shear * state.diagonal[0] + mean, xy_stress, zx_stress},
                               {xy_stress, shear * state.diagonal[1] + mean, yz_stress},
                               {zx_stress, yz_stress, shear * state.diagonal[2] + mean}};
    const double volume = C::volume * d * d * d;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            state.traction[b][a] =
                volume * (stress[a][0] * inverse[0][b] + stress[a][1] * inverse[1][b] + stress[a][2] * inverse[2][b]);
    Real outward = sums.outward[0] * sums.outward[0] + C::smoothing * C::smoothing;
    for (int c = 1; c < 3; ++c) outward += sums.outward[c] * sums.outward[c];
    const Real squared = (sums.of_own[0] * sums.of_own[0] + sums.of_own[1] * sums.of_own[1] +
                          sums.of_own[2] * sums.of_own[2]) /
                         (C::inside * C::inside);
    state.inside = 1.0 - squared * squared;
    state.inside = state.inside > 0.0 ? state.inside : 0.0 * state.inside;
    root(outward);
    const Real density = sums.density + C::surface * (outward - C::smoothing);
    state.background = C::background * d * d * material.strength * state.inside;
    state.pressure =
        C::pressure * d * d * material.strength * (density / C::rest_density - 1.0) + state.background;
    const Real lateral = C::surface * state.pressure / outward;
    for (int c = 0; c < 3; ++c) state.lateral[c] = lateral * sums.outward[c];
}

}  // namespace tomodem::law
