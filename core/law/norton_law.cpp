#include "core/law/norton_law.hpp"

#include <algorithm>
#include <cmath>

#include "core/law/norton_state.hpp"

namespace tomodem::law {

using C = NortonConstants;

NortonState norton_state(const Norton& law, const NortonMaterial& material, const NortonSums& sums) {
    NortonSumsOf<double> of{};
    for (int c = 0; c < 3; ++c) {
        std::copy_n(sums.moment[c], 3, of.moment[c]);
        of.diagonal[c] = sums.diagonal[c];
        of.off[c] = sums.off[c];
        of.outward[c] = sums.outward[c];
        of.of_own[c] = sums.of_own[c];
    }
    of.density = sums.diagonal[3];
    NortonStateOf<double> found;
    norton_state(
        law, NortonMaterialOf<double>{material.consistency, material.rate_sensitivity, material.strength}, of,
        [](double& base, double exponent) { base = std::pow(base, exponent); },
        [](double& square) { square = std::sqrt(square); }, found);
    NortonState state{};
    for (int c = 0; c < 3; ++c) {
        for (int b = 0; b < 3; ++b) state.traction[b][c] = found.traction[b][c];
        state.diagonal[c] = found.diagonal[c];
        state.off[c] = found.off[c];
        state.lateral[c] = found.lateral[c];
        std::copy_n(found.inverse[c], 3, state.inverse[c]);
    }
    state.background = found.background;
    state.inside = found.inside;
    state.traction[0][3] = found.pressure;
    state.traction[1][3] = found.viscosity;
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
        for (int b = 0; b < 3; ++b) force[c] -= (weight * i.traction[b][c] + (2 - weight) * j.traction[b][c]) * apart[b];
    }
}

void norton_correct(const Norton& law, NortonState& state, const double (&virial)[3][3], double background) {
    const double trace = virial[0][0] + virial[1][1] + virial[2][2], mean = (trace - background) / 3;
    double squares = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) squares += 1.5 * std::pow(virial[a][b] - (a == b ? trace / 3 : 0), 2);
    const double most = C::most_corrected * C::volume * std::pow(law.seed_diameter, 3) * state.strength();
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
