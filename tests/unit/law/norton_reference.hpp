#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/law/norton_law.hpp"

namespace tomodem::law {

/// The law on a whole sample, every pair on its own, in double precision: what kernels are compared with.
class NortonReference {
 public:
    using Vector = Eigen::Vector3d;

    Norton law;
    std::vector<Vector> positions, velocities;
    std::vector<int> materials;         ///< from 0
    std::vector<std::int32_t> objects;  ///< empty: one

    std::size_t count() const { return positions.size(); }
    Vector apart(std::size_t i, std::size_t j) const { return positions[i] - positions[j]; }
    Vector speed(std::size_t i, std::size_t j) const { return velocities[i] - velocities[j]; }
    bool same(std::size_t i, std::size_t j) const { return objects.empty() || objects[i] == objects[j]; }

    /// w_ij of the pairs of two materials, by these states; without it every pair has 1.
    void weigh(const std::vector<NortonState>& states) {
        weights_.assign(count() * count(), 1.0);
        for_pairs([&](std::size_t i, std::size_t j) {
            if (materials[i] != materials[j])
                weights_[i * count() + j] = norton_weight(states[i].viscosity(), states[j].viscosity());
        });
    }

    std::vector<NortonState> states() const {
        std::vector<NortonSums> sums(count(), NortonSums{});
        for_pairs([&](std::size_t i, std::size_t j) { add(i, j, sums[i]); });
        std::vector<NortonState> states;
        for (std::size_t i = 0; i < count(); ++i)
            states.push_back(norton_state(law, law.materials[static_cast<std::size_t>(materials[i])], sums[i]));
        return states;
    }

    /// Takes from the states' tractions what the other forces carry of the stress.
    void correct(std::vector<NortonState>& states) const {
        // The forces without tractions, and those of the background alone.
        std::vector<NortonState> rest = states, background = states;
        for (std::size_t i = 0; i < count(); ++i)
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) rest[i].traction[b][a] = background[i].traction[b][a] = 0;
                background[i].lateral[a] *= states[i].background / states[i].pressure();
            }
        for (std::size_t i = 0; i < count(); ++i) {
            background[i].traction[0][3] = states[i].background;
            background[i].traction[1][3] = 1e-300;
            background[i].traction[2][3] = 0;
            if (law.at_rest) rest[i].traction[1][3] = 1e-300;
        }
        for (std::size_t i = 0; i < count(); ++i) {
            double virial[3][3] = {}, trace = 0;
            for_neighbours(i, [&](std::size_t j) {
                if (!same(i, j)) return;
                const Vector away = apart(i, j), moving = speed(i, j);
                Vector force, backed;
                norton_force(law, rest[i], rest[j], away.data(), moving.data(), true, force.data());
                norton_force(law, background[i], background[j], away.data(), moving.data(), true, backed.data());
                for (int a = 0; a < 3; ++a)
                    for (int b = 0; b < 3; ++b) virial[a][b] += 0.25 * (force[a] * away[b] + force[b] * away[a]);
                trace += 0.5 * backed.dot(away);
            });
            const NortonMaterial& material = law.materials[static_cast<std::size_t>(materials[i])];
            norton_correct(law, states[i], virial, trace,
                           material.consistency * std::pow(law.flow_rate, material.rate_sensitivity));
        }
    }

    /// As the solver takes them: weights by the flow, found twice, and corrected tractions.
    std::vector<NortonState> corrected_states() {
        weights_.clear();
        std::vector<NortonState> found = states();
        for (int pass = 0; pass < 2 && law.materials.size() > 1 && !law.at_rest; ++pass) {
            weigh(found);
            found = states();
        }
        correct(found);
        return found;
    }

    /// @param loads  becomes the sum of the magnitudes of each particle's pair forces; null: not asked for
    std::vector<Vector> forces(const std::vector<NortonState>& states, std::vector<double>* loads = nullptr) const {
        std::vector<Vector> forces(count(), Vector::Zero());
        if (loads != nullptr) loads->assign(count(), 0);
        for_pairs([&](std::size_t i, std::size_t j) {
            const Vector away = apart(i, j), moving = speed(i, j);
            Vector force;
            norton_force(law, states[i], states[j], away.data(), moving.data(), same(i, j), force.data(), weight(i, j));
            forces[i] += force;
            if (loads != nullptr) (*loads)[i] += force.norm();
        });
        return forces;
    }

 private:
    double weight(std::size_t i, std::size_t j) const { return weights_.empty() ? 1 : weights_[i * count() + j]; }

    template <class Use>
    void for_neighbours(std::size_t i, Use use) const {
        for (std::size_t j = 0; j < count(); ++j)
            if (i != j && apart(i, j).norm() <= NortonConstants::crown * law.seed_diameter) use(j);
    }
    template <class Use>
    void for_pairs(Use use) const {
        for (std::size_t i = 0; i < count(); ++i) for_neighbours(i, [&](std::size_t j) { use(i, j); });
    }

    void add(std::size_t i, std::size_t j, NortonSums& sums) const {
        const Vector away = apart(i, j), moving = speed(i, j);
        const double closeness = std::pow(1 - away.norm() / (NortonConstants::crown * law.seed_diameter), 2);
        const double share = weight(i, j), in_fabric = (1 + share) / 2;
        for (int c = 0; c < 3; ++c) {
            sums.outward[c] += closeness * away[c] / away.norm();
            if (!same(i, j)) continue;
            sums.of_own[c] += closeness * away[c] / away.norm();
            for (int b = 0; b < 3; ++b) sums.moment[c][b] += share * moving[c] * away[b];
            sums.diagonal[c] += in_fabric * away[c] * away[c];
            sums.off[c] += in_fabric * away[c] * away[(c + 1) % 3];
        }
        sums.diagonal[3] += closeness;
    }

    std::vector<double> weights_;  ///< empty: 1 everywhere
};

}  // namespace tomodem::law
