#include "solver_plugin/norton/coarse_grid.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/unit/norton/one_process.hpp"

namespace tomodem::plugin {
namespace {

constexpr double edge = 8;

std::vector<double> points(int count) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0, edge);
    std::vector<double> all(3 * static_cast<std::size_t>(count));
    for (double& x : all) x = place(random);
    return all;
}

/// Layers at both ends stick to walls along z that pull them apart: in the grid's body, whose bulk is free to follow
/// (Poisson's ratio 0), the motion between them is linear in z.
TEST(CoarseGrid, FindsTheUniformStretchBetweenTwoWalls) {
    constexpr int along = 16, count = along * along * along;
    std::vector<double> position;
    for (int k = 0; k < count; ++k)
        for (const int at : {k % along, k / along % along, k / along / along})
            position.push_back(at == 0 ? 0 : at == along - 1 ? edge : edge / along * (at + 0.5));
    const OneProcess surroundings;
    CoarseGrid grid;
    grid.lay(position.data(), count, 2, surroundings);
    std::vector<NearWall> walls;
    std::vector<Four> force(count, Four{});
    const double stiffness = 1e4;
    for (int i = 0; i < count; ++i) {
        const double z = position[3 * i + 2];
        if (z > 0 && z < edge) continue;
        const double side = z < edge / 2 ? 1 : -1;
        walls.push_back({i, 0, {0, 0, side}, 0, 0});
        force[i][2] = static_cast<float>(-stiffness * side);  // of a wall that moves by 1 outwards
    }
    grid.fill(std::vector<CoarseGrid::Material>(count, {1, 0}), walls, 0, std::vector<double>(walls.size(), stiffness),
              surroundings);
    std::vector<double> nodes(static_cast<std::size_t>(grid.size()), 0.0);
    grid.gather(force.data(), nodes.data());
    grid.solve(nodes.data());
    std::vector<Four> motion(count, Four{});
    grid.spread(nodes.data(), motion.data());
    for (int i = 0; i < count; ++i) {
        const double z = position[3 * i + 2];
        EXPECT_NEAR(motion[i][2], (z - edge / 2) / (edge / 2), 0.01) << z;
    }
}

TEST(CoarseGrid, TakesForcesToTheNodesAndMotionBackWithTheSameWeights) {
    constexpr int count = 50;
    const std::vector<double> position = points(count);
    CoarseGrid grid;
    grid.lay(position.data(), count, 2, OneProcess{});
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<Four> force(count), motion(count, Four{});
    std::vector<double> nodes(static_cast<std::size_t>(grid.size())), gathered(nodes.size(), 0.0);
    for (Four& one : force)
        for (int c = 0; c < 3; ++c) one[c] = static_cast<float>(number(random));
    for (double& one : nodes) one = number(random);
    grid.gather(force.data(), gathered.data());
    grid.spread(nodes.data(), motion.data());
    double on_nodes = 0, on_particles = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) on_nodes += gathered[k] * nodes[k];
    for (int i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) on_particles += static_cast<double>(force[i][c]) * motion[i][c];
    EXPECT_NEAR(on_nodes, on_particles, 1e-5);
}

}  // namespace
}  // namespace tomodem::plugin
