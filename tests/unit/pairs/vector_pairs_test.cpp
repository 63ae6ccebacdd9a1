#include "solver_plugin/pairs/vector_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solver_plugin/pairs/scalar_pairs.hpp"

namespace tomodem::plugin {
namespace {

constexpr double time_step = 0.01;

/// Random particles of two types, the last `ghosts` of them ghosts, and their half list within crown and skin.
struct Cloud {
    static constexpr int types = 2;
    std::vector<double> position, velocity, radius;
    std::vector<int> type, rows, lengths;
    std::vector<std::int32_t> id, object;
    std::vector<std::vector<int>> neighbours;
    std::vector<const int*> first;
    int local;

    Cloud(int count, int ghosts, double reach, double dispersion = 0) : local(count - ghosts) {
        std::mt19937_64 random(7);
        const double edge = std::cbrt(count / 1.3);
        std::uniform_real_distribution<double> place(0, edge), speed(-1, 1);
        for (int k = 0; k < 3 * count; ++k) {
            position.push_back(place(random));
            velocity.push_back(speed(random));
        }
        for (int k = 0; k < count; ++k) {
            type.push_back(1 + static_cast<int>(random() % types));
            object.push_back(static_cast<std::int32_t>(random() % 3));
            radius.push_back(0.75 * (1 + dispersion * speed(random)));
            id.push_back(k + 1);
        }
        std::shuffle(id.begin(), id.end(), random);
        list_pairs(reach);
    }
    void list_pairs(double reach) {
        const auto count = static_cast<int>(type.size());
        neighbours.assign(count, {});
        lengths.assign(count, 0);
        rows.clear();
        first.clear();
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
    void advance() {
        for (std::size_t k = 0; k < position.size(); ++k) position[k] += time_step * velocity[k];
    }
    ParticleView particles(bool by_object = false) const {
        return {position.data(),
                velocity.data(),
                radius.data(),
                type.data(),
                id.data(),
                local,
                static_cast<int>(type.size()),
                by_object ? object.data() : nullptr};
    }
    NeighbourView list() const { return {local, rows.data(), lengths.data(), first.data(), 0x1FFFFFFF}; }
};

PairLaws two_materials(bool bounded, bool dispersed = false) {
    law::Pair soft{1, 1.5, 2.65e9, 2.65e8}, stiff{1, 1.5, 6.23e9, 6.23e8};
    if (bounded) {
        soft.max_attraction = 5e7;
        stiff.max_attraction = 9e7;
    }
    PairLaws laws;
    laws.of_types = {soft, law::mixed(soft, stiff), law::mixed(soft, stiff), stiff};
    laws.type_count = 2;
    laws.dispersed = dispersed;
    laws.seed_to_crown = 1 / 1.5;
    return laws;
}

constexpr PairStep first_step{.number = 0, .time_step = time_step, .renumbered = true, .set_up = true};

std::vector<double> reference(const PairLaws& laws, const Cloud& cloud, bool by_object = false) {
    std::vector<double> forces(3 * cloud.local, 0.0);
    scalar_pairs(laws, cloud.particles(by_object), cloud.list(), first_step, forces.data(), nullptr,
                 [](int, int, const double*, const double*) {});
    return forces;
}

void expect_equal(const std::vector<double>& forces, const std::vector<double>& expected) {
    ASSERT_EQ(forces.size(), expected.size());
    for (std::size_t k = 0; k < forces.size(); ++k) EXPECT_NEAR(forces[k], expected[k], 1e-13 * 6.23e9 * 10) << k;
}

/// Bounded attraction, dispersed radii, objects told apart, self-contact.
class EveryLoop : public testing::TestWithParam<std::tuple<bool, bool, bool, bool>> {};

INSTANTIATE_TEST_SUITE_P(VectorPairs, EveryLoop,
                         testing::Combine(testing::Bool(), testing::Bool(), testing::Bool(), testing::Bool()));

TEST_P(EveryLoop, DoesWhatTheFormulasDoWhileParticlesMove) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    const auto [bounded, dispersed, by_object, remembers] = GetParam();
    Cloud cloud(600, 80, 2.4, dispersed ? 0.1 : 0.0);
    const PairLaws laws = two_materials(bounded, dispersed);
    VectorPairs pairs;
    pairs.set_laws(laws, 0.1);
    ContactMemory vector_memory, scalar_memory;
    for (ContactMemory* memory : {&vector_memory, &scalar_memory}) {
        memory->set_law({.min_outward = 1.0});
        memory->resize(cloud.local, static_cast<int>(cloud.type.size()) - cloud.local);
    }
    int most_interfaces = 0;
    for (int step = 0; step < 40; ++step) {
        if (step > 0) cloud.advance();
        const PairStep now{step, time_step, step == 0, step == 0};
        std::vector<double> forces(3 * cloud.local, 0.0), expected(3 * cloud.local, 0.0);
        pairs.add_forces(cloud.particles(by_object), now, forces.data(), remembers ? &vector_memory : nullptr);
        scalar_pairs(laws, cloud.particles(by_object), cloud.list(), now, expected.data(),
                     remembers ? &scalar_memory : nullptr, [](int, int, const double*, const double*) {});
        expect_equal(forces, expected);
        if (!remembers) continue;
        vector_memory.finish_step();
        scalar_memory.finish_step();
        int interfaces = 0;
        for (int i = 0; i < cloud.local; ++i) {
            ASSERT_EQ(vector_memory.interfaces(i).size(), scalar_memory.interfaces(i).size()) << "step " << step;
            for (const auto& known : scalar_memory.interfaces(i))
                EXPECT_TRUE(vector_memory.is_interface(i, known.partner));
            interfaces += static_cast<int>(scalar_memory.interfaces(i).size());
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(vector_memory.outward()[i][c], scalar_memory.outward()[i][c], 1e-12);
        }
        most_interfaces = std::max(most_interfaces, interfaces);
    }
    EXPECT_GT(pairs.packed().list().listings(), 3);
    if (remembers) {
        EXPECT_GT(most_interfaces, 50) << "the case shows nothing";
    }
}

TEST(VectorPairs, ListAgainOnlyWhenAParticleHasMovedHalfTheInnerSkin) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    Cloud cloud(400, 60, 1.8);
    const PairLaws laws = two_materials(false);
    VectorPairs pairs;
    pairs.set_laws(laws, 0.1);
    std::vector<double> forces(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(), first_step, forces.data());
    for (const auto& [move, listings] : {std::pair{0.049, 1}, std::pair{0.002, 2}}) {
        for (double& x : cloud.position) x += move / std::sqrt(3.0);
        std::swap(cloud.velocity[0], cloud.velocity[7]);
        forces.assign(forces.size(), 0.0);
        pairs.add_forces(cloud.particles(), {1, time_step, false, false}, forces.data());
        EXPECT_EQ(pairs.packed().list().listings(), listings);
        expect_equal(forces, reference(laws, cloud));
    }
}

TEST(VectorPairs, ListAFewThatStrayByThemselves) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    Cloud cloud(600, 80, 0);
    const PairLaws laws = two_materials(false);
    VectorPairs pairs;
    pairs.set_laws(laws, 0.1);
    std::vector<double> forces(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(true), first_step, forces.data());
    // Some of this process, some ghosts; the first of them twice, into each other's reach and out of the old one's.
    for (const auto& strayed : {std::vector{3, 40, 41, 517, 530, 599}, std::vector{3, 530, 200}}) {
        for (const int i : strayed)
            for (int c = 0; c < 3; ++c) cloud.position[3 * i + c] += 0.7 * (c - i % 2);
        if (strayed.back() == 200)
            for (int c = 0; c < 3; ++c) cloud.position[600 + c] = cloud.position[120 + c] + 0.4;  // beside particle 40
        cloud.list_pairs(2.4);
        forces.assign(forces.size(), 0.0);
        pairs.add_forces(cloud.particles(true), {1, time_step, false, false}, forces.data());
        expect_equal(forces, reference(laws, cloud, true));
    }
    EXPECT_EQ(pairs.packed().list().listings(), 1);
}

TEST(VectorPairs, AddToWhatIsThere) {
    if (!VectorPairs::supported()) GTEST_SKIP() << "this machine has no AVX2";
    const Cloud cloud(50, 0, 1.8);
    VectorPairs pairs;
    pairs.set_laws(two_materials(true), 0.1);
    std::vector<double> once(3 * cloud.local, 0.0), twice(3 * cloud.local, 0.0);
    pairs.add_forces(cloud.particles(), first_step, once.data());
    pairs.add_forces(cloud.particles(), first_step, twice.data());
    pairs.add_forces(cloud.particles(), {1, time_step, false, false}, twice.data());
    for (std::size_t k = 0; k < once.size(); ++k) EXPECT_DOUBLE_EQ(twice[k], 2 * once[k]);
}

}  // namespace
}  // namespace tomodem::plugin
