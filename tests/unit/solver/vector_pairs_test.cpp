#include "solver_plugin/vector_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tomodem::plugin {
namespace {

/// Random particles of two types, the last `ghosts` of them ghosts, and their half list within crown and skin.
struct Cloud {
    static constexpr int types = 2;
    std::vector<double> position, velocity;
    std::vector<int> type, rows, lengths;
    std::vector<std::vector<int>> neighbours;
    std::vector<const int*> first;
    int local;

    Cloud(int count, int ghosts, double reach) : local(count - ghosts) {
        std::mt19937_64 random(7);
        const double edge = std::cbrt(count / 1.3);
        std::uniform_real_distribution<double> place(0, edge), speed(-1, 1);
        for (int k = 0; k < 3 * count; ++k) {
            position.push_back(place(random));
            velocity.push_back(speed(random));
        }
        for (int k = 0; k < count; ++k) type.push_back(1 + static_cast<int>(random() % types));
        neighbours.resize(count);
        lengths.resize(count);
        for (int i = 0; i < local; ++i) {
            rows.push_back(i);
            for (int j = i + 1; j < count; ++j)
                if (distance(i, j) < reach) neighbours[i].push_back(j);
            lengths[i] = static_cast<int>(neighbours[i].size());
        }
        for (const auto& list : neighbours) first.push_back(list.data());
    }
    double distance(int i, int j) const {
        double squared = 0;
        for (int c = 0; c < 3; ++c) squared += std::pow(position[3 * i + c] - position[3 * j + c], 2);
        return std::sqrt(squared);
    }
    ParticleView particles() const {
        return {position.data(), velocity.data(), type.data(), local, static_cast<int>(type.size())};
    }
    NeighbourView list() const { return {local, rows.data(), lengths.data(), first.data(), 0x1FFFFFFF}; }
    std::vector<double> reference(const std::vector<law::Bilin>& laws) const {
        std::vector<double> forces(3 * local, 0.0);
        for (int i = 0; i < local; ++i)
            for (int j : neighbours[i]) {
                const double h = distance(i, j);
                double rate = 0;
                for (int c = 0; c < 3; ++c)
                    rate +=
                        (position[3 * i + c] - position[3 * j + c]) * (velocity[3 * i + c] - velocity[3 * j + c]) / h;
                const double force = law::bilin_force(laws[(type[i] - 1) * types + type[j] - 1], h, rate);
                for (int c = 0; c < 3; ++c) {
                    const double component = force * (position[3 * i + c] - position[3 * j + c]) / h;
                    forces[3 * i + c] += component;
                    if (j < local) forces[3 * j + c] -= component;
                }
            }
        return forces;
    }
};

const law::Bilin soft{1, 1.5, 2.65e9, 2.65e8}, stiff{1, 1.5, 6.23e9, 6.23e8};
const std::vector<law::Bilin> laws{soft, law::mixed(soft, stiff), law::mixed(soft, stiff), stiff};

void expect_equal(const std::vector<double>& forces, const std::vector<double>& expected) {
    ASSERT_EQ(forces.size(), expected.size());
    for (std::size_t k = 0; k < forces.size(); ++k) EXPECT_NEAR(forces[k], expected[k], 1e-13 * 6.23e9 * 10) << k;
}

TEST(VectorPairs, GiveTheForcesOfTheFormulaForTwoTypesWithGhosts) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    const Cloud cloud(400, 60, 1.8);
    VectorPairs pairs;
    pairs.set_laws(laws, 2, 0.1);
    std::vector<double> forces(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(), cloud.list(), true, forces.data());
    expect_equal(forces, cloud.reference(laws));
}

TEST(VectorPairs, PruneAgainOnlyWhenAParticleHasMovedHalfTheInnerSkin) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    Cloud cloud(400, 60, 1.8);
    VectorPairs pairs;
    pairs.set_laws(laws, 2, 0.1);
    std::vector<double> forces(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(), cloud.list(), true, forces.data());
    for (const auto& [move, prunings] : {std::pair{0.049, 1}, std::pair{0.002, 2}}) {
        for (double& x : cloud.position) x += move / std::sqrt(3.0);
        std::swap(cloud.velocity[0], cloud.velocity[7]);
        forces.assign(forces.size(), 0.0);
        pairs.add_forces(cloud.particles(), cloud.list(), false, forces.data());
        EXPECT_EQ(pairs.prunings(), prunings);
        expect_equal(forces, cloud.reference(laws));
    }
}

TEST(VectorPairs, AddToWhatIsThere) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    const Cloud cloud(50, 0, 1.8);
    VectorPairs pairs;
    pairs.set_laws(laws, 2, 0.1);
    std::vector<double> once(3 * cloud.local, 0.0), twice(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(), cloud.list(), true, once.data());
    pairs.add_forces(cloud.particles(), cloud.list(), true, twice.data());
    pairs.add_forces(cloud.particles(), cloud.list(), false, twice.data());
    for (std::size_t k = 0; k < once.size(); ++k) EXPECT_DOUBLE_EQ(twice[k], 2 * once[k]);
}

}  // namespace
}  // namespace tomodem::plugin
