#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/law/pair.hpp"
#include "solver_plugin/simulation/simulation.hpp"
#include "tests/unit/solver/simulation_probe.hpp"

namespace tomodem {
namespace {

using plugin::Simulation;

constexpr double relative = 1e-12;

Model two_phase_model() {
    Model model;
    model.seed_radius = 0.5;
    model.crown_radius = 0.75;
    model.time_step = 5e-4;
    model.phases = {{1, {1.0, 1.5, 6.23e9, 6.23e8}, 0.1, 1.578e6, 0.0},
                    {2, {1.0, 1.5, 2.65e9, 2.65e8}, 2.53, 4.3e8, 0.0}};
    return model;
}

/// Two particles `distance` apart in a direction that is along no axis.
Packing pair_of(std::int32_t first, std::int32_t second, double distance, double seed_radius = 0.5) {
    Packing packing;
    packing.seed_radius = seed_radius;
    packing.box.edges = Vec3::Constant(10);
    const Vec3 direction = Vec3(1, -2, 2) / 3;
    packing.position = {Vec3(3, 4, 5), Vec3(3, 4, 5) + distance * direction};
    packing.species = {first, second};
    packing.id = {1, 2};
    return packing;
}

/// Signed force on the second particle along the line from the first, for a given rate of the distance.
double force_in_liggghts(const Packing& pair, double rate, int axis = 2) {
    Simulation simulation(pair, two_phase_model(), axis, MPI_COMM_WORLD);
    const Vec3 direction = (pair.position[1] - pair.position[0]).normalized();
    const auto forces =
        plugin::SimulationProbe(simulation).forces_at({Vec3(-0.3, 0.1, 0.2), Vec3(-0.3, 0.1, 0.2) + rate * direction});
    EXPECT_LT((forces[0] + forces[1]).norm(), relative * (1 + forces[0].norm())) << "action is not reaction";
    EXPECT_NEAR(forces[1].cross(direction).norm(), 0, 1e-9 * (1 + forces[1].norm())) << "force is not central";
    return forces[1].dot(direction);
}

class LawInLiggghts : public testing::TestWithParam<const char*> {
 protected:
    void SetUp() override { setenv("TOMODEM_KERNEL", GetParam(), 1); }
    void TearDown() override { unsetenv("TOMODEM_KERNEL"); }
};

INSTANTIATE_TEST_SUITE_P(BothKernels, LawInLiggghts, testing::Values("scalar", "vector"));

TEST_P(LawInLiggghts, RepelsInTheSeedWhateverTheRate) {
    const law::Pair law = two_phase_model().phases[0].pair;
    for (double distance : {0.5, 0.9, 0.99})
        for (double rate : {-0.2, 0.2}) {
            const double expected = law::pair_force(law, distance, rate);
            ASSERT_GT(expected, 0);
            EXPECT_NEAR(force_in_liggghts(pair_of(1, 1, distance), rate), expected, relative * law.repulsive_stiffness);
        }
}

TEST_P(LawInLiggghts, AttractsInTheCrownOnlyWhileSeparating) {
    const law::Pair law = two_phase_model().phases[0].pair;
    for (double distance : {1.1, 1.3, 1.49}) {
        const double expected = law::pair_force(law, distance, 0.2);
        ASSERT_LT(expected, 0);
        EXPECT_NEAR(force_in_liggghts(pair_of(1, 1, distance), 0.2) / expected, 1, relative);
        EXPECT_EQ(force_in_liggghts(pair_of(1, 1, distance), -0.2), 0);
    }
}

TEST_P(LawInLiggghts, EndsAtTheCrown) {
    EXPECT_EQ(force_in_liggghts(pair_of(1, 1, 1.51), 0.2), 0);
}

TEST_P(LawInLiggghts, TakesTheAverageOfTwoMaterials) {
    const Model model = two_phase_model();
    const law::Pair law = law::mixed(model.phases[0].pair, model.phases[1].pair);
    EXPECT_DOUBLE_EQ(law.repulsive_stiffness, (6.23e9 + 2.65e9) / 2);
    EXPECT_NEAR(force_in_liggghts(pair_of(1, 2, 0.8), 0.1) / law::pair_force(law, 0.8, 0.1), 1, relative);
    EXPECT_NEAR(force_in_liggghts(pair_of(2, 1, 1.2), 0.1) / law::pair_force(law, 1.2, 0.1), 1, relative);
}

TEST_P(LawInLiggghts, IsTheSameAlongEveryLoadingAxis) {
    const double along_z = force_in_liggghts(pair_of(1, 1, 0.8), 0.1, 2);
    EXPECT_NEAR(force_in_liggghts(pair_of(1, 1, 0.8), 0.1, 0) / along_z, 1, relative);
    EXPECT_NEAR(force_in_liggghts(pair_of(1, 1, 0.8), 0.1, 1) / along_z, 1, relative);
}

TEST_P(LawInLiggghts, ScalesWithTheSectionForASampleOfAnotherSize) {
    // A sample 50 times smaller under the same stresses: forces are 2500 times smaller.
    const double reference = force_in_liggghts(pair_of(1, 1, 0.8), 0.1);
    EXPECT_NEAR(force_in_liggghts(pair_of(1, 1, 0.8 / 50, 0.01), 0.1 / 50) * 2500 / reference, 1, relative);
}

TEST_P(LawInLiggghts, ActsBetweenParticleAndPlane) {
    Packing pair = pair_of(1, 1, 1);
    pair.position = {Vec3(0, 0, 0), Vec3(0, 0, 10)};
    const Model model = two_phase_model();
    const law::Pair law{model.seed_radius, model.crown_radius, 6.23e9, 6.23e8};
    for (double distance : {0.3, 0.45, 0.55, 0.7, 0.76}) {
        for (double speed_away : {-0.2, 0.2}) {
            Simulation simulation(pair, model, 2, MPI_COMM_WORLD);
            simulation.place_planes();
            // The planes start one seed radius outside and close by a strain: the distance to both is then `distance`.
            simulation.set_loading({.strain = std::log(1 + 2 * (distance - model.seed_radius) / 10)});
            const auto forces =
                plugin::SimulationProbe(simulation).forces_at({Vec3(0, 0, speed_away), Vec3(0, 0, -speed_away)});
            const double expected = law::pair_force(law, distance, speed_away);
            EXPECT_NEAR(forces[0].z(), expected, relative * law.repulsive_stiffness) << distance << ' ' << speed_away;
            EXPECT_NEAR(forces[1].z(), -expected, relative * law.repulsive_stiffness) << distance << ' ' << speed_away;
        }
    }
}

Model trilin_model() {
    Model model = two_phase_model();
    model.crown_radius = 0.7;
    model.law = &trilin_law();
    model.phases = {{1, {1.0, 1.4, 1.42e9, 4.73e8, 1e8}, 1.0, 3.6e7, 0.0}};
    return model;
}

double force_on_second(const Packing& pair, const Model& model, double rate) {
    Simulation simulation(pair, model, 2, MPI_COMM_WORLD);
    const Vec3 direction = (pair.position[1] - pair.position[0]).normalized();
    return plugin::SimulationProbe(simulation).forces_at({Vec3::Zero(), rate * direction})[1].dot(direction);
}

TEST_P(LawInLiggghts, BoundsTheAttractionOfTrilin) {
    const Model model = trilin_model();
    EXPECT_NEAR(force_on_second(pair_of(1, 1, 1.1), model, 0.1) / -4.73e7, 1, relative);
    EXPECT_NEAR(force_on_second(pair_of(1, 1, 1.35), model, 0.1) / -1e8, 1, relative);
    EXPECT_EQ(force_on_second(pair_of(1, 1, 1.35), model, -0.1), 0);
    EXPECT_NEAR(force_on_second(pair_of(1, 1, 0.9), model, 0.1) / 1.42e8, 1, relative);
}

TEST_P(LawInLiggghts, DoesNotAttractBetweenObjectsButRepels) {
    Model model = trilin_model();
    model.objects_only_push = true;
    Packing apart = pair_of(1, 1, 1.2), touching = pair_of(1, 1, 0.9);
    apart.object = touching.object = {1, 2};
    EXPECT_EQ(force_on_second(apart, model, 0.1), 0);
    EXPECT_NEAR(force_on_second(touching, model, 0.1) / 1.42e8, 1, relative);
    apart.object = {3, 3};
    EXPECT_NEAR(force_on_second(apart, model, 0.1) / -9.46e7, 1, relative);
}

TEST_P(LawInLiggghts, ScalesSeedAndCrownWithTheRadiiOfThePair) {
    Model model = trilin_model();
    model.radius_dispersion = 0.1;
    // The sum of the radii from where the repulsion ends; it is the same for every distance.
    const auto force_at = [&](double distance) {
        Packing pair = pair_of(1, 1, distance);
        pair.id = {1, 4};
        return force_on_second(pair, model, 0.1);
    };
    const double seeds = 0.8 + force_at(0.8) / 1.42e9;
    EXPECT_GT(std::abs(seeds - 1), 1e-3);
    EXPECT_NEAR(seeds, 1, 0.3);
    EXPECT_NEAR(force_at(0.7) / (1.42e9 * (seeds - 0.7)), 1, 1e-9);
    EXPECT_NEAR(force_at(1.4 * seeds - 1e-6) / -1e8, 1, relative);
    EXPECT_EQ(force_at(1.4 * seeds + 1e-6), 0);
}

TEST_P(LawInLiggghts, TakesTheRadiiThatTheSampleBrings) {
    // Seeds touch at 0.6 + 0.3 in a sample of seed radius 0.5, the crowns at 1.4 times that; also in a scaled sample.
    for (const double scale : {1.0, 0.02}) {
        const auto force_at = [&](double distance) {
            Packing pair = pair_of(1, 1, distance * scale, 0.5 * scale);
            pair.radius = {0.6 * scale, 0.3 * scale};
            return force_on_second(pair, trilin_model(), 0.1 * scale) / (scale * scale);
        };
        EXPECT_NEAR(force_at(0.8) / (1.42e9 * 0.1), 1, 1e-9);
        EXPECT_NEAR(force_at(0.95) / (-4.73e8 * 0.05), 1, 1e-9);
        EXPECT_EQ(force_at(1.4 * 0.9 + 1e-6), 0);
        EXPECT_NEAR(force_at(1.4 * 0.9 - 1e-6) / -1e8, 1, 1e-9);
    }
}

TEST_P(LawInLiggghts, SwingsWithItsNaturalPeriod) {
    // Two equal masses that overlap by d: h = 2 r_s - d cos(w t), w^2 = 2 k / m, until they part.
    Model model = two_phase_model();
    Simulation simulation(pair_of(1, 1, 0.98), model, 2, MPI_COMM_WORLD);
    const double frequency = std::sqrt(2.0) * 2 * std::numbers::pi / 0.1;
    for (int steps : {7, 9, 11}) {
        simulation.run(steps);
        const double time = static_cast<double>(simulation.step()) * model.time_step;
        const auto points = simulation.positions();
        EXPECT_NEAR((points[1] - points[0]).norm(), 1 - 0.02 * std::cos(frequency * time), 1e-5) << simulation.step();
    }
}

}  // namespace
}  // namespace tomodem
