#include "core/law/norton_law.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

namespace tomodem::law {
namespace {

using C = NortonConstants;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double diameter = 0.8;

/// Centres at random, none nearer than 0.6 seeds.
std::vector<Vector3d> cloud(int count, double edge) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> place(0, edge);
    std::vector<Vector3d> points;
    while (static_cast<int>(points.size()) < count) {
        const Vector3d point(place(random), place(random), place(random));
        bool free = true;
        for (const Vector3d& other : points) free = free && (point - other).norm() > 0.6 * diameter;
        if (free) points.push_back(point);
    }
    return points;
}

Norton norton(double sensitivity) {
    return {.seed_diameter = diameter, .min_rate = 0, .flow_rate = 1e-3, .materials = {{3e7, sensitivity, 2e6}}};
}

NortonSums sums_of(const std::vector<Vector3d>& points, const std::vector<Vector3d>& velocities, std::size_t i) {
    NortonSums sums{};
    for (std::size_t j = 0; j < points.size(); ++j) {
        const Vector3d apart = points[i] - points[j], speed = velocities[i] - velocities[j];
        const double closeness = 1 - apart.norm() / (C::crown * diameter);
        if (j == i || closeness < 0) continue;
        for (int c = 0; c < 3; ++c) {
            for (int b = 0; b < 3; ++b) sums.moment[c][b] += speed[c] * apart[b];
            sums.diagonal[c] += apart[c] * apart[c];
            sums.off[c] += apart[c] * apart[(c + 1) % 3];
            sums.of_own[c] = sums.outward[c] += closeness * closeness * apart[c] / apart.norm();
        }
        sums.diagonal[3] += closeness * closeness;
    }
    return sums;
}

struct Sample {
    Norton law;
    std::vector<Vector3d> points = cloud(60, 3.2), velocities = std::vector<Vector3d>(60, Vector3d::Zero());

    std::vector<NortonState> states() const {
        std::vector<NortonState> states;
        for (std::size_t i = 0; i < points.size(); ++i)
            states.push_back(norton_state(law, law.materials[0], sums_of(points, velocities, i)));
        return states;
    }
    /// @param background  with it; it has no energy
    std::vector<Vector3d> forces(bool background = true) const {
        std::vector<NortonState> found = states();
        for (NortonState& state : found) {
            if (background) continue;
            const double pressure = state.pressure() - state.background;
            for (double& part : state.lateral) part *= pressure / state.pressure();
            state.traction[0][3] = pressure;
        }
        std::vector<Vector3d> forces(points.size(), Vector3d::Zero());
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t j = 0; j < points.size(); ++j) {
                const Vector3d apart = points[i] - points[j], speed = velocities[i] - velocities[j];
                if (j == i || apart.norm() > C::crown * diameter) continue;
                Vector3d force;
                norton_force(law, found[i], found[j], apart.data(), speed.data(), true, force.data());
                forces[i] += force;
            }
        return forces;
    }
    /// Of the pressure and of the cores.
    double energy() const {
        double energy = 0;
        const double strength = law.materials[0].strength;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const NortonSums sums = sums_of(points, velocities, i);
            const Vector3d outward(sums.outward);
            const double density =
                sums.diagonal[3] +
                C::surface * (std::sqrt(outward.squaredNorm() + C::smoothing * C::smoothing) - C::smoothing);
            energy += C::crown * diameter * C::pressure * strength * diameter * diameter * C::rest_density / 2 *
                      std::pow(density / C::rest_density - 1, 2);
            for (std::size_t j = 0; j < i; ++j) {
                const double overlap = std::max(0.0, C::core * diameter - (points[i] - points[j]).norm());
                energy += 0.5 * C::core_stiffness * diameter * strength * overlap * overlap;
            }
        }
        return energy;
    }
};

TEST(NortonLaw, TheForceAtRestIsTheGradientOfAnEnergySurfaceIncluded) {
    Sample sample{norton(0.5)};
    sample.law.at_rest = true;
    const std::vector<Vector3d> forces = sample.forces(false);
    double largest = 0;
    for (const Vector3d& force : forces) largest = std::max(largest, force.norm());
    constexpr double step = 1e-6;
    for (std::size_t i = 0; i < sample.points.size(); i += 7)
        for (int c = 0; c < 3; ++c) {
            Sample moved = sample;
            moved.points[i][c] += step;
            const double up = moved.energy();
            moved.points[i][c] -= 2 * step;
            EXPECT_NEAR(forces[i][c], -(up - moved.energy()) / (2 * step), 1e-6 * largest);
        }
}

/// A jittered cubic lattice, and which of its points is in the middle.
struct Middle {
    std::vector<Vector3d> points;
    std::size_t index = 0;
    Middle() {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> jitter(-0.1, 0.1);
        for (int x = -2; x <= 2; ++x)
            for (int y = -2; y <= 2; ++y)
                for (int z = -2; z <= 2; ++z) {
                    if (x == 0 && y == 0 && z == 0) index = points.size();
                    const Vector3d away(jitter(random), jitter(random), jitter(random));
                    points.push_back(0.9 * diameter * (Vector3d(x, y, z) + away));
                }
    }
    NortonState state(const Norton& law, const Matrix3d& gradient) const {
        std::vector<Vector3d> velocities;
        for (const Vector3d& point : points) velocities.push_back(gradient * point);
        return norton_state(law, law.materials[0], sums_of(points, velocities, index));
    }
};

TEST(NortonLaw, ABodyThatRotatesHasNoRateOfDeformation) {
    Matrix3d spin;
    spin << 0, -0.5, -0.7, 0.5, 0, -0.3, 0.7, 0.3, 0;
    Norton law = norton(0.3);
    law.min_rate = 1e-9;
    const NortonState state = Middle().state(law, spin);
    // But for the floor of the fabric, whose share differs a little from direction to direction.
    for (int c = 0; c < 3; ++c) {
        EXPECT_LT(std::abs(state.diagonal[c]), 0.01);
        EXPECT_LT(std::abs(state.off[c]), 0.01);
    }
}

TEST(NortonLaw, AUniformFlowIsSeenAtItsRate) {
    constexpr double rate = 1e-3;
    const Matrix3d flow = Vector3d(rate / 2, rate / 2, -rate).asDiagonal();
    const NortonState state = Middle().state(norton(0.25), flow);
    // The fabric of a particle that has its neighbours has no floor.
    EXPECT_NEAR(state.diagonal[2], -rate, 1e-3 * rate);
    EXPECT_NEAR(state.viscosity(), 3e7 * std::pow(rate, -0.75), 1e-3 * state.viscosity());
}

TEST(NortonLaw, ForcesGrowWithTheRateToThePowerM) {
    const auto force_at = [](double rate, double sensitivity) {
        Sample sample{norton(sensitivity)};
        sample.law.materials[0].strength = 1e-30;
        for (std::size_t i = 0; i < sample.points.size(); ++i)
            sample.velocities[i] = Vector3d(rate / 2, rate / 2, -rate).cwiseProduct(sample.points[i]);
        double sum = 0;
        for (const Vector3d& force : sample.forces()) sum += force.squaredNorm();
        return std::sqrt(sum);
    };
    for (const double sensitivity : {0.1, 0.5, 1.0})
        EXPECT_NEAR(std::log10(force_at(1e-2, sensitivity) / force_at(1e-3, sensitivity)), sensitivity, 1e-9);
}

TEST(NortonLaw, PairsOfTwoBodiesPushAndNeverPull) {
    Sample sample{norton(0.5)};
    const std::vector<NortonState> states = sample.states();
    int pushing = 0;
    for (std::size_t i = 0; i < states.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const Vector3d apart = sample.points[i] - sample.points[j], speed(1, 2, 3);
            if (apart.norm() > C::crown * diameter) continue;
            Vector3d force;
            norton_force(sample.law, states[i], states[j], apart.data(), speed.data(), false, force.data());
            EXPECT_GE(force.dot(apart), 0);
            EXPECT_LT(force.cross(apart).norm(), 1e-9 * (1 + force.norm()));
            pushing += force.norm() > 0;
        }
    EXPECT_GT(pushing, 10) << "the case shows nothing";
}

TEST(NortonLaw, AWallsFilmBringsTheParticleToTheWallsVelocity) {
    const Norton law = norton(1);
    constexpr double strength = 2e6, time_step = 0.1, mass = 1e9;
    const double film = C::wall_viscosity * diameter * strength / law.flow_rate;
    const double force = norton_wall_force(law, strength, 0.5, 2e-3, 0, time_step / mass);
    const double after = 2e-3 + time_step / mass * force;
    EXPECT_NEAR(force, -film * after, 1e-9 * std::abs(force));
    EXPECT_LT(std::abs(after), 2e-3 / (1 + film * time_step / mass) * 1.0001);
    // Nearer than a seed's radius it is held off.
    EXPECT_GT(norton_wall_force(law, strength, 0.3, 0, 0, time_step / mass), 0);
}

}  // namespace
}  // namespace tomodem::law
