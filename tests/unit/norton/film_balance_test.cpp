#include "solver_plugin/norton/film_balance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "solver_plugin/norton/flow_forces.hpp"
#include "tests/unit/norton/cloud.hpp"
#include "tests/unit/norton/one_process.hpp"

namespace tomodem::plugin {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Films of two phases, as an explicit step lays them, and the same by a dense solution in double precision.
class FilmBalanceTest : public testing::Test {
 protected:
    static constexpr double time_step = 0.02 / rate;

    Cloud cloud{60};
    std::vector<NearWall> walls = walls_at(cloud);
    std::vector<double> mass;
    FlowForces forces;
    FilmBalance balance;

    FilmBalanceTest() {
        // The film is three times as stiff as an explicit step could bear, and more in the second phase.
        const double damping = damping_of(0);
        for (int i = 0; i < cloud.count(); ++i) mass.push_back(damping * time_step / 3 * (1 + 0.2 * (i % 3)));
        forces.set_law(norton());
        forces.set_carry([](void*, std::size_t, std::size_t) {});
        forces.place(cloud.view());
        forces.set_interval(0);
        forces.set_rate(rate);
        forces.find_corrected(cloud.fours().data());
    }

    ParticleView view() const {
        ParticleView view = cloud.view();
        view.mass = mass.data();
        return view;
    }
    static double damping_of(int material) {
        const law::NortonMaterial of = norton().materials[static_cast<std::size_t>(material)];
        return law::NortonConstants::film * diameter * of.consistency * std::pow(rate, of.rate_sensitivity - 1);
    }
    double repulsion(const NearWall& wall) const {
        const double strength = norton().materials[static_cast<std::size_t>(cloud.type[wall.particle] - 1)].strength;
        return law::NortonConstants::core_stiffness * diameter * strength * std::max(0.0, diameter / 2 - wall.distance);
    }
    void solve() {
        forces.lay_films(walls, balance);
        balance.solve(
            view(), forces.net(), time_step, [](void*, std::size_t, std::size_t) {}, OneProcess());
    }
    VectorXd force_of_films() const {
        std::vector<double> sum(mass.size() * 3, 0.0);
        balance.add_forces(sum.data());
        for (const NearWall& wall : walls)
            for (int c = 0; c < 3; ++c)
                sum[3 * wall.particle + c] +=
                    (balance.plane_force(wall.particle, wall.wall) - repulsion(wall)) * wall.normal[c];
        return Eigen::Map<const VectorXd>(sum.data(), static_cast<Eigen::Index>(sum.size()));
    }
};

TEST_F(FilmBalanceTest, HasTheForcesOfADenseSolutionOfTheEndOfTheStep) {
    const auto films = static_cast<Eigen::Index>(walls.size());
    const Eigen::Index numbers = 3 * cloud.count();
    std::vector<Vector3d> others;
    for (int i = 0; i < cloud.count(); ++i) others.push_back(vector(forces.net()[i]));
    solve();

    // The slip that the film of the quasi-static scheme has with each velocity, column by column.
    FlowForces quasi_static = forces;
    quasi_static.set_walls(walls);
    MatrixXd slips(films, numbers);
    for (Eigen::Index column = 0; column < numbers; ++column) {
        std::vector<Four> one(static_cast<std::size_t>(cloud.count()), Four{});
        one[static_cast<std::size_t>(column / 3)][static_cast<int>(column % 3)] = 1;
        quasi_static.find(one.data());
        for (Eigen::Index k = 0; k < films; ++k) {
            const NearWall& wall = walls[static_cast<std::size_t>(k)];
            const int type = cloud.type[wall.particle];
            const double approach = column / 3 == wall.particle ? wall.normal[column % 3] : 0;
            const double force = quasi_static.wall_force({wall.particle,
                                                          type,
                                                          0,
                                                          wall.distance,
                                                          approach,
                                                          0,
                                                          0,
                                                          {wall.normal[0], wall.normal[1], wall.normal[2]}});
            slips(k, column) = (repulsion(wall) - force) / damping_of(type - 1);
        }
    }
    VectorXd compliance(films), wall_velocity(films), velocity(numbers), mobility(numbers);
    for (Eigen::Index n = 0; n < numbers; ++n) {
        const auto i = static_cast<std::size_t>(n / 3);
        mobility[n] = time_step / mass[i];
        velocity[n] = cloud.velocity[static_cast<std::size_t>(n)] + mobility[n] * others[i][n % 3];
    }
    for (Eigen::Index k = 0; k < films; ++k) {
        const NearWall& wall = walls[static_cast<std::size_t>(k)];
        compliance[k] = 1 / damping_of(cloud.type[wall.particle] - 1);
        wall_velocity[k] = wall.velocity;
        for (int c = 0; c < 3; ++c)
            velocity[3 * wall.particle + c] += mobility[3 * wall.particle + c] * repulsion(wall) * wall.normal[c];
    }
    MatrixXd system = slips * mobility.asDiagonal() * slips.transpose();
    system.diagonal() += compliance;
    const VectorXd wanted = slips.transpose() * system.ldlt().solve(wall_velocity - slips * velocity);
    EXPECT_GT(films, 20);
    EXPECT_LT((force_of_films() - wanted).norm(), 1e-3 * wanted.norm());
    EXPECT_LT(balance.iterations(), 60);
}

TEST_F(FilmBalanceTest, HasTheSameForcesInThePairs) {
    solve();
    VectorXd with = -force_of_films();
    for (const NearWall& wall : walls)
        for (int c = 0; c < 3; ++c)
            with[3 * wall.particle + c] +=
                (balance.plane_force(wall.particle, wall.wall) - repulsion(wall)) * wall.normal[c];
    const double size = with.norm();
    const auto add_pairs = [&](double sign) {
        forces.for_each_force(cloud.fours().data(), [&](int i, int j, const double* force, const double*) {
            for (int c = 0; c < 3; ++c) {
                with[3 * i + c] += sign * force[c];
                with[3 * j + c] -= sign * force[c];
            }
        });
    };
    add_pairs(-1);
    forces.add_to_tractions(balance);
    add_pairs(1);
    EXPECT_LT(with.norm(), 1e-3 * size);
}

}  // namespace
}  // namespace tomodem::plugin
