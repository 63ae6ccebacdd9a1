#include "core/law/norton_law.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::law {

using C = NortonConstants;

double norton_fabric_floor(double diameter, const double* diagonal, const double* off) {
    const double square = diameter * diameter;
    const double minors[3] = {diagonal[1] * diagonal[2] - off[1] * off[1], diagonal[0] * diagonal[2] - off[2] * off[2],
                              diagonal[0] * diagonal[1] - off[0] * off[0]};
    const double determinant = diagonal[0] * minors[0] + off[0] * (off[1] * off[2] - off[0] * diagonal[2]) +
                               off[2] * (off[0] * off[1] - diagonal[1] * off[2]);
    const double all = minors[0] + minors[1] + minors[2];
    // Neighbours in one line, or none.
    if (all <= 1e-9 * square * square) return C::fabric_floor * square;
    return C::fabric_floor * square / (1 + std::pow(3 * determinant / (all * square), 4));
}

NortonState norton_state(const Norton& law, const NortonMaterial& material, const NortonSums& sums) {
    NortonState state{};
    const double d = law.seed_diameter;
    const double floor = norton_fabric_floor(d, sums.diagonal, sums.off);
    const double xx = sums.diagonal[0] + floor, yy = sums.diagonal[1] + floor, zz = sums.diagonal[2] + floor;
    const double xy = sums.off[0], yz = sums.off[1], zx = sums.off[2];
    // A is symmetric and, with the floor, positive.
    const double cofactor[6] = {yy * zz - yz * yz, xx * zz - zx * zx, xx * yy - xy * xy,
                                yz * zx - xy * zz, xy * zx - xx * yz, xy * yz - yy * zx};
    const double over = 1 / (xx * cofactor[0] + xy * cofactor[3] + zx * cofactor[5]);
    for (int c = 0; c < 3; ++c) {
        state.inverse[c][c] = cofactor[c] * over;
        state.inverse[c][(c + 1) % 3] = state.inverse[(c + 1) % 3][c] = cofactor[3 + c] * over;
    }
    double gradient[3][3] = {};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int c = 0; c < 3; ++c) gradient[a][b] += sums.moment[a][c] * state.inverse[c][b];
    const double growth = gradient[0][0] + gradient[1][1] + gradient[2][2];
    double squares = 0;
    for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3;
        state.diagonal[c] = gradient[c][c];
        state.off[c] = gradient[c][next] + gradient[next][c];
        squares += std::pow(gradient[c][c] - growth / 3, 2) + 0.5 * std::pow(state.off[c], 2);
    }
    const double squared_rate =
        law.at_rest ? law.flow_rate * law.flow_rate : 2.0 / 3 * squares + law.min_rate * law.min_rate;
    const double viscosity = material.consistency * std::pow(squared_rate, 0.5 * (material.rate_sensitivity - 1));

    const double shear = 2.0 / 3 * viscosity, mean = (C::bulk_viscosity * viscosity - shear / 3) * growth;
    double stress[3][3];
    for (int c = 0; c < 3; ++c) {
        stress[c][c] = shear * state.diagonal[c] + mean;
        stress[c][(c + 1) % 3] = stress[(c + 1) % 3][c] = 0.5 * shear * state.off[c];
    }
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int c = 0; c < 3; ++c)
                state.traction[b][a] += C::volume * d * d * d * stress[a][c] * state.inverse[c][b];

    double outward = C::smoothing * C::smoothing, of_own = 0;
    for (int c = 0; c < 3; ++c) {
        outward += sums.outward[c] * sums.outward[c];
        of_own += sums.of_own[c] * sums.of_own[c];
    }
    outward = std::sqrt(outward);
    state.inside = std::max(0.0, 1 - std::pow(of_own / (C::inside * C::inside), 2));
    state.background = C::background * d * d * material.strength * state.inside;
    const double density = sums.diagonal[3] + C::surface * (outward - C::smoothing);
    const double pressure =
        C::pressure * d * d * material.strength * (density / C::rest_density - 1) + state.background;
    for (int c = 0; c < 3; ++c) state.lateral[c] = C::surface * pressure / outward * sums.outward[c];
    state.traction[0][3] = pressure;
    state.traction[1][3] = viscosity;
    state.traction[2][3] = material.strength;
    return state;
}

void norton_force(const Norton& law, const NortonState& i, const NortonState& j, const double* apart,
                  const double* speed, bool bonded, double* force, double weight) {
    const double d = law.seed_diameter;
    const double distance = std::sqrt(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]);
    const double closeness = std::max(0.0, 1 - distance / (C::crown * d));
    const double overlap = std::max(0.0, C::core * d - distance);
    double radial = C::core_stiffness * d * (i.strength() + j.strength()) / 2 * overlap +
                    2 * closeness * (i.pressure() + j.pressure());
    if (!bonded) {
        radial -= 2 * closeness * (i.background + j.background);
        for (int c = 0; c < 3; ++c) force[c] = std::max(0.0, radial) / distance * apart[c];
        return;
    }
    double separation = 0, mean_flow = 0, lateral = 0;
    for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3;
        separation += speed[c] * apart[c] / distance;
        mean_flow += (i.diagonal[c] + j.diagonal[c]) / 2 * apart[c] * apart[c] / distance +
                     (i.off[c] + j.off[c]) / 2 * apart[c] * apart[next] / distance;
        lateral += (i.lateral[c] - j.lateral[c]) * apart[c] / distance;
    }
    const double viscosity = 2 * i.viscosity() * j.viscosity() / (i.viscosity() + j.viscosity());
    radial += 2 * closeness * lateral - C::pair_share * d * viscosity * (separation - mean_flow);
    const double across = -C::crown * d / distance * closeness * closeness;
    for (int c = 0; c < 3; ++c) {
        force[c] = (radial - across * lateral) / distance * apart[c] + across * (i.lateral[c] - j.lateral[c]);
        for (int b = 0; b < 3; ++b)
            force[c] -= (weight * i.traction[b][c] + (2 - weight) * j.traction[b][c]) * apart[b];
    }
}

void norton_correct(const Norton& law, NortonState& state, const double (&virial)[3][3], double background,
                    double flow_stress) {
    const double trace = virial[0][0] + virial[1][1] + virial[2][2], mean = (trace - background) / 3;
    double squares = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) squares += 1.5 * std::pow(virial[a][b] - (a == b ? trace / 3 : 0), 2);
    const double most = C::most_corrected * C::volume * std::pow(law.seed_diameter, 3) * flow_stress;
    const double share = state.inside * std::min(1.0, most / std::sqrt(squares));
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int c = 0; c < 3; ++c)
                state.traction[b][a] += share * (virial[a][c] - (a == c ? mean : 0)) * state.inverse[c][b];
}

double norton_wall_force(const Norton& law, double strength, double distance, double approach, double other,
                         double time_step_over_mass) {
    const double d = law.seed_diameter;
    const double repulsion = C::core_stiffness * d * strength * std::max(0.0, d / 2 - distance);
    // Not the particle's own viscosity, which falls where a sample begins to tear off.
    const double film = C::wall_viscosity * d * strength / law.flow_rate;
    const double after = (approach + time_step_over_mass * (other + repulsion)) / (1 + time_step_over_mass * film);
    return repulsion - film * after;
}

}  // namespace tomodem::law
