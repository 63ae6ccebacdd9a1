#include "tools/vol2pack/sample.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "core/base/error.hpp"
#include "tools/vol2pack/geometric_error.hpp"
#include "tools/vol2pack/phase_report.hpp"
#include "tools/vol2pack/resolution.hpp"

namespace tomodem::vol2pack {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

/// n^3 points on a cubic lattice of distance 2 r_s, half a distance from the faces of the box.
Packing lattice(int n, double seed_radius = 0.5) {
    Packing brick;
    brick.seed_radius = seed_radius;
    brick.box.edges = Vec3::Constant(2 * seed_radius * n);
    brick.box.periodic = {true, true, true};
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) brick.position.push_back(2 * seed_radius * Vec3(x + 0.5, y + 0.5, z + 0.5));
    brick.species.assign(brick.size(), 1);
    for (std::size_t i = 0; i < brick.size(); ++i) brick.id.push_back(static_cast<std::int64_t>(i + 1));
    return brick;
}

Packing random_points(int count, unsigned seed) {
    Packing brick = lattice(1);
    brick.box.edges = Vec3(3, 4, 5);
    brick.position.clear();
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < count; ++i)
        brick.position.push_back(brick.box.edges.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random))));
    brick.species.assign(count, 1);
    return brick;
}

LabelVolume volume_of(VoxelIndex size, double spacing, const std::function<std::int32_t(int, int, int)>& label,
                      Vec3 origin = Vec3::Zero()) {
    LabelVolume volume(size, Vec3::Constant(spacing), origin);
    std::vector<std::int32_t> voxels;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) voxels.push_back(label(x, y, z));
    volume.set_slices(0, size[2], voxels);
    return volume;
}

struct SampleOptions {
    double seed_radius = 0.0;
    LabelFilter filter{};
    std::vector<std::int32_t> object_labels{};  // each connected component of one of these is an object of its own
    std::uint64_t random_seed = 0;
    std::int64_t max_particles = 50'000'000;
    int threads = 1;
};

Sample sample_volume(const LabelVolume& volume, const Packing& brick, const SampleOptions& options) {
    const Tiling tiling(brick, options.seed_radius, {volume.origin(), volume.extent(), {false, false, false}},
                        options.random_seed, options.max_particles);
    std::optional<Regions> regions;
    if (!options.object_labels.empty())
        regions = component_regions(volume, options.object_labels, options.object_labels, Connectivity::faces);
    return vol2pack::sample_volume(volume, tiling, regions ? &*regions : nullptr, options.filter, options.threads);
}

TEST(Sample, OfALatticeHasOneParticleForEachOfItsCells) {
    // 12 x 8 x 20 voxels of 0.1 mm; seeds of 2 voxels take 4 voxels each: 3 x 2 x 5 particles.
    const auto volume = volume_of(
        {12, 8, 20}, 0.1, [](int, int, int) { return 1; }, Vec3(7, 8, 9));
    const Sample sample = sample_volume(volume, lattice(2), {.seed_radius = 0.2});
    EXPECT_EQ(sample.packing.size(), 30U);
    EXPECT_EQ(sample.packing.seed_radius, 0.2);
    EXPECT_EQ(sample.packing.box.origin, Vec3(7, 8, 9));
    EXPECT_TRUE(sample.packing.box.edges.isApprox(Vec3(1.2, 0.8, 2)));
    EXPECT_THAT(sample.packing.box.periodic, ElementsAre(false, false, false));
    EXPECT_FALSE(sample.packing.relaxed);
    EXPECT_TRUE(sample.packing.object.empty());
    EXPECT_TRUE(sample.packing.position[0].isApprox(Vec3(7.2, 8.2, 9.2)));
    for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(sample.packing.id[i], static_cast<std::int64_t>(i + 1));
}

TEST(Sample, KeepsTheDensityOfTheBrick) {
    const Packing brick = random_points(20000, 1);
    const auto volume = volume_of({50, 50, 50}, 0.1, [](int, int, int) { return 1; });
    const Sample sample = sample_volume(volume, brick, {.seed_radius = 0.2});
    // 333 particles per seed-scaled mm^3: scale 0.4, so 20000 / (60 * 0.064) per mm^3 over 125 mm^3; Poisson scatter.
    const double expected = 20000 / (60 * 0.064) * 125;
    EXPECT_NEAR(static_cast<double>(sample.packing.size()) / expected, 1, 0.02);
}

TEST(Sample, TakesTheLabelUnderEachParticleAndDropsTheVoid) {
    // Halves along y: 0 and 3.
    const auto volume = volume_of({16, 16, 16}, 1, [](int, int y, int) { return y < 8 ? 0 : 3; });
    const Sample sample = sample_volume(volume, lattice(4), {.seed_radius = 2});
    EXPECT_EQ(sample.candidates, 64);
    EXPECT_THAT(sample.labelled, ElementsAre(Pair(0, 32), Pair(3, 32)));
    for (std::size_t i = 0; i < sample.packing.size(); ++i) {
        EXPECT_EQ(sample.packing.species[i], 3);
        EXPECT_GT(sample.packing.position[i][1], 8);
    }
}

TEST(Sample, FollowsTheAxesOfTheImage) {
    // A label that is different along each axis: x is the column, y the row, z the slice.
    const auto volume = volume_of({4, 6, 8}, 1, [](int x, int y, int z) { return 1 + x + 10 * y + 100 * z; });
    const Sample sample = sample_volume(volume, lattice(8), {.seed_radius = 0.5});
    ASSERT_EQ(sample.packing.size(), 4U * 6 * 8);
    for (std::size_t i = 0; i < sample.packing.size(); ++i) {
        const Vec3& p = sample.packing.position[i];
        EXPECT_EQ(sample.packing.species[i], 1 + int(p[0]) + 10 * int(p[1]) + 100 * int(p[2]));
    }
}

TEST(Sample, BoxFilterRemovesASpeckThatTheNearestVoxelKeeps) {
    // Particles at 2, 6, 10 ... of a voxel 1 among 2s: the voxel that holds (6, 6, 6).
    const auto volume =
        volume_of({12, 12, 12}, 1, [](int x, int y, int z) { return x == 6 && y == 6 && z == 6 ? 1 : 2; });
    const Packing brick = lattice(3);
    SampleOptions options{.seed_radius = 2};
    EXPECT_EQ(sample_volume(volume, brick, options).labelled.at(1), 1);
    options.filter.kind = Filter::box;
    EXPECT_EQ(sample_volume(volume, brick, options).labelled.count(1), 0U);
}

TEST(Sample, HasAnObjectForEachComponentInRasterOrder) {
    // Four columns along z: 1 2 1 2 along x, the first and the last cut in two along z.
    const auto volume = volume_of({16, 4, 16}, 1, [](int x, int, int z) {
        const int column = x / 4;
        if ((column == 0 || column == 3) && z >= 7 && z < 9) return 9;
        return column % 2 ? 2 : 1;
    });
    const Sample sample = sample_volume(volume, lattice(4), {.seed_radius = 2, .object_labels = {1}});
    EXPECT_EQ(sample.components, 3);
    EXPECT_EQ(sample.lost_components(), 0);
    EXPECT_THAT(sample.object_particles, ElementsAre(2, 4, 2));
    for (std::size_t i = 0; i < sample.packing.size(); ++i) {
        const Vec3& p = sample.packing.position[i];
        const int expected = p[0] < 4 ? (p[2] < 8 ? 1 : 3) : p[0] > 8 && p[0] < 12 ? 2 : 0;
        EXPECT_EQ(sample.packing.object[i], expected) << p.transpose();
    }
}

TEST(Sample, TouchingComponentsOfTwoLabelsAreTwoObjects) {
    const auto volume = volume_of({8, 4, 4}, 1, [](int x, int, int) { return x < 4 ? 1 : 2; });
    const Sample sample = sample_volume(volume, lattice(1), {.seed_radius = 2, .object_labels = {1, 2}});
    EXPECT_THAT(sample.packing.object, ElementsAre(1, 2));
}

TEST(Sample, LeavesOutComponentsWithoutParticlesFromTheNumbers) {
    // The voxel in the corner is nobody's centre.
    const auto volume = volume_of({8, 4, 4}, 1, [](int x, int y, int z) { return x + y + z == 0 ? 2 : x < 4 ? 1 : 2; });
    const Sample sample = sample_volume(volume, lattice(1), {.seed_radius = 2, .object_labels = {2}});
    EXPECT_EQ(sample.components, 2);
    EXPECT_EQ(sample.lost_components(), 1);
    EXPECT_THAT(sample.packing.object, ElementsAre(0, 1));
}

TEST(Sample, ParticleMovedByTheBoxFilterBelongsToTheNearestComponentOfItsLabel) {
    // The centre (2, 2, 2) lies in a crack of label 1 between two pieces of label 2, nearer to the upper one.
    const auto volume = volume_of({4, 4, 4}, 1, [](int, int, int z) { return z == 2 ? 1 : 2; });
    const Sample sample =
        sample_volume(volume, lattice(1), {.seed_radius = 2, .filter = {Filter::box}, .object_labels = {2}});
    EXPECT_THAT(sample.packing.species, ElementsAre(2));
    EXPECT_EQ(sample.components, 2);
    EXPECT_THAT(sample.packing.object, ElementsAre(1));
    EXPECT_THAT(sample.object_particles, ElementsAre(1));
}

TEST(Sample, TakesTheRadiiOfTheBricksParticlesAtItsScale) {
    // The brick's particles have a radius that encodes their z; at a fifth of the size it encodes the sample's.
    Packing brick = lattice(2);
    for (const Vec3& p : brick.position) brick.radius.push_back(0.4 + 0.1 * p.z());
    const auto volume = volume_of({8, 8, 16}, 0.1, [](int x, int, int) { return x < 4 ? 0 : 1; });
    const Sample sample = sample_volume(volume, brick, {.seed_radius = 0.1, .object_labels = {}});
    ASSERT_EQ(sample.packing.size(), 2u * 4u * 8u);
    ASSERT_EQ(sample.packing.radius.size(), sample.packing.size());
    for (std::size_t i = 0; i < sample.packing.size(); ++i) {
        const double z_in_brick = std::fmod(sample.packing.position[i].z(), 0.4) * 5;
        EXPECT_NEAR(sample.packing.radius[i], (0.4 + 0.1 * z_in_brick) / 5, 1e-12);
    }
    brick.radius.clear();
    EXPECT_TRUE(sample_volume(volume, brick, {.seed_radius = 0.1, .object_labels = {}}).packing.radius.empty());
}

TEST(Sample, IsTheSameOnAnyNumberOfThreads) {
    const Packing brick = random_points(50000, 2);
    const auto volume = volume_of({40, 30, 20}, 0.1, [](int x, int y, int z) { return (x / 7 + y / 5 + z / 6) % 3; });
    SampleOptions options{.seed_radius = 0.3, .filter = {Filter::box}, .object_labels = {1, 2}, .random_seed = 4};
    const Sample one = sample_volume(volume, brick, options);
    options.threads = 3;
    const Sample three = sample_volume(volume, brick, options);
    EXPECT_EQ(one.packing.position, three.packing.position);
    EXPECT_EQ(one.packing.species, three.packing.species);
    EXPECT_EQ(one.packing.object, three.packing.object);
}

TEST(Sample, RandomSeedMovesTheBrickWithoutChangingItsPacking) {
    const auto volume = volume_of({40, 40, 40}, 1, [](int, int, int) { return 1; });
    const Packing brick = lattice(4);
    const auto sample = [&](std::uint64_t seed) {
        return sample_volume(volume, brick, {.seed_radius = 2, .random_seed = seed}).packing;
    };
    const Packing first = sample(1), second = sample(2);
    EXPECT_EQ(sample(0).size(), 1000U) << "the box holds whole cells";
    EXPECT_EQ(sample(1).position, first.position);
    EXPECT_NE(second.position, first.position);
    for (const Packing& packing : {first, second}) {
        EXPECT_NEAR(static_cast<double>(packing.size()), 1000, 60);
        // Each particle away from the faces has the six neighbours of the lattice at 2 r_s and no nearer one.
        for (const Vec3& at : packing.position) {
            if (((at - Vec3::Constant(20)).cwiseAbs().array() > 14).any()) continue;
            int neighbours = 0;
            for (const Vec3& other : packing.position) {
                const double distance = (other - at).norm();
                if (distance > 1e-9) {
                    EXPECT_GT(distance, 4 - 1e-9);
                }
                neighbours += std::abs(distance - 4) < 1e-9;
            }
            ASSERT_EQ(neighbours, 6);
        }
    }
    // Rotated: the lattice is not parallel to the box any more.
    const Vec3 step = first.position[1] - first.position[0];
    EXPECT_GT(step.cwiseAbs().minCoeff(), 1e-3);
}

TEST(Sample, WrapsPositionsThatLieOutsideTheBrick) {
    Packing brick = lattice(2);
    brick.position[0] += Vec3(10, -6, 0);
    brick.position[7] = Vec3(2, -1e-18, 2);
    const auto volume = volume_of({16, 16, 16}, 1, [](int, int, int) { return 1; });
    const Sample sample = sample_volume(volume, brick, {.seed_radius = 4});
    EXPECT_EQ(sample.packing.size(), 8U);
}

TEST(Sample, OfARotatedBrickHasTheDensityOfTheBrickEverywhere) {
    // A brick with three different edges, larger and smaller than the image.
    const Packing brick = random_points(20000, 1);
    for (const double seed_radius : {0.05, 0.2, 0.9}) {
        const auto volume = volume_of({50, 40, 30}, 0.1, [](int, int, int) { return 1; });
        const double expected = 20000 / (60 * std::pow(2 * seed_radius, 3)) * 60;
        if (expected > 3e6) continue;
        for (std::uint64_t seed : {1, 2, 3}) {
            const Sample sample = sample_volume(volume, brick, {.seed_radius = seed_radius, .random_seed = seed});
            const auto count = static_cast<double>(sample.packing.size());
            EXPECT_NEAR(count / expected, 1, 0.02 + 6 / std::sqrt(expected));
            Vec3 mean = Vec3::Zero();
            for (const Vec3& at : sample.packing.position) mean += at / count;
            EXPECT_LT((mean.cwiseQuotient(volume.extent()) - Vec3::Constant(0.5)).cwiseAbs().maxCoeff(),
                      0.005 + 2 / std::sqrt(expected));
        }
    }
}

TEST(Sample, OfABrickThatIsPeriodicAlongTwoAxesFitsIntoItAlongTheThird) {
    Packing brick = lattice(5);
    brick.box.periodic[2] = false;
    const auto slab = volume_of({40, 28, 18}, 1, [](int, int, int) { return 1; });
    EXPECT_EQ(sample_volume(slab, brick, {.seed_radius = 2}).packing.size(), 10U * 7 * 4);
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Packing packing = sample_volume(slab, brick, {.seed_radius = 2, .random_seed = seed}).packing;
        EXPECT_NEAR(static_cast<double>(packing.size()), 40 * 28 * 18 / 64.0, 60);
        // Turned about z only: the layers stay level.
        for (const Vec3& at : packing.position)
            EXPECT_NEAR(std::abs(std::remainder(at[2] - packing.position[0][2], 4.0)), 0, 1e-9);
    }
    brick.box.periodic = {false, false, false};
    const auto small = volume_of({12, 12, 12}, 1, [](int, int, int) { return 1; });
    EXPECT_EQ(sample_volume(small, brick, {.seed_radius = 2}).packing.size(), 27U);
    EXPECT_THAT(
        [&] { sample_volume(slab, brick, {.seed_radius = 2}); },
        ThrowsMessage<InvalidInput>(HasSubstr("not periodic along x, so it cannot be repeated there, and at this "
                                              "scale it is 20 mm long where the image has 40 mm")));
}

TEST(LabelObjects, AreOneObjectEachAndShareAPhase) {
    // Grains 10, 11 and 70000 side by side, the last in two pieces; 5 is another phase.
    const std::array<std::int32_t, 6> columns{10, 70000, 5, 11, 5, 70000};
    auto volume = volume_of({24, 4, 4}, 1, [&](int x, int, int) { return columns[x / 4]; });
    const std::vector<LabelObjects> ranges{{10, 80000, 1}};
    EXPECT_THAT(species_histogram(volume, ranges), ElementsAre(Pair(1, 256), Pair(5, 128)));
    const auto regions = distinguish_regions(volume, {}, ranges, Connectivity::faces, Regions::Of::objects);
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(1, 256), Pair(5, 128)));
    const Tiling tiling(lattice(2), 2, {volume.origin(), volume.extent(), {}}, 0);
    const Sample sample = sample_volume(volume, tiling, &*regions, {}, 1);
    EXPECT_THAT(sample.packing.species, ElementsAre(1, 1, 5, 1, 5, 1));
    EXPECT_THAT(sample.object_number, ElementsAre(10, 11, 70000));
    EXPECT_THAT(sample.object_particles, ElementsAre(1, 1, 2));
    for (std::size_t i = 0; i < 6; ++i) {
        const std::int32_t label = columns[static_cast<std::size_t>(sample.packing.position[i][0] / 4)];
        EXPECT_EQ(sample.packing.object[i], label == 5 ? 0 : label);
    }
}

TEST(LabelObjects, AreFollowedByTheComponentsOfOtherLabels) {
    const std::array<std::int32_t, 4> columns{3, 7, 3, 8};
    auto volume = volume_of({16, 4, 4}, 1, [&](int x, int, int) { return columns[x / 4]; });
    const auto regions = distinguish_regions(volume, {3}, {{7, 8, 1}}, Connectivity::faces, Regions::Of::everything);
    const Tiling tiling(lattice(4), 2, {volume.origin(), volume.extent(), {}}, 0);
    const Sample sample = sample_volume(volume, tiling, &*regions, {}, 1);
    EXPECT_THAT(sample.packing.object, ElementsAre(9, 7, 10, 8));
    EXPECT_EQ(sample.components, 4);
}

TEST(LabelObjects, AreRefusedWhereTheImageHasNoneOfThem) {
    auto volume = volume_of({2, 2, 2}, 1, [](int, int, int) { return 1; });
    EXPECT_THAT(
        [&] {
            distinguish_regions(volume, {}, {{5, 9, 1}}, Connectivity::faces, Regions::Of::objects);
        },
        ThrowsMessage<InvalidInput>(HasSubstr("no label from 5 to 9")));
}

LabelVolume ball(int size, double radius) {
    return volume_of({size, size, size}, 1, [=](int x, int y, int z) {
        return (Vec3(x, y, z) - Vec3::Constant(size / 2.0 - 0.5)).norm() < radius ? 1 : 2;
    });
}

TEST(Resolution, IsTheCoarsestThatKeepsTheErrorWhateverTheRandomSeed) {
    const auto volume = ball(48, 15);
    const Packing brick = random_points(4000, 3);  // far denser than a packing: many particles a voxel
    for (const std::uint64_t seed : {0, 5}) {
        const auto steps = choose_resolution(
            volume, brick,
            {.max_error = 0.1, .pixel = 1, .filter = {Filter::level_set}, .random_seed = seed, .threads = 2});
        for (std::size_t i = 0; i + 1 < steps.size(); ++i) EXPECT_GT(steps[i].error, 0.1);
        EXPECT_LE(steps.back().error, 0.1);
        const Sample sample = sample_volume(
            volume, brick,
            {.seed_radius = steps.back().pixels_per_seed, .filter = {Filter::level_set}, .random_seed = seed});
        EXPECT_LE(largest_volume_error(volume.histogram(), sample.labelled), 0.1);
    }
}

TEST(Resolution, IsRefusedWhereOneVoxelOrTheMostParticlesDoNotReachTheError) {
    const Packing brick = lattice(10);
    const auto volume = ball(20, 3);
    EXPECT_THAT([&] { choose_resolution(volume, brick, {.max_error = 1e-4, .pixel = 1}); },
                ThrowsMessage<InvalidInput>(testing::AllOf(HasSubstr("within 0.01 %: even a radius of 1 voxel has"),
                                                           HasSubstr("the smallest error is"))));
    EXPECT_THAT([&] { choose_resolution(volume, brick, {.max_error = 1e-4, .pixel = 1, .max_particles = 300}); },
                ThrowsMessage<InvalidInput>(HasSubstr("more than the 300 allowed")));
}

TEST(Sample, RejectsABrickThatIsEmpty) {
    const auto volume = volume_of({4, 4, 4}, 1, [](int, int, int) { return 1; });
    EXPECT_THAT([&] { sample_volume(volume, Packing{}, {.seed_radius = 1}); },
                ThrowsMessage<InvalidInput>(HasSubstr("no particles")));
}

TEST(Sample, RejectsTooManyParticlesBeforeMakingThem) {
    const auto volume = volume_of({4, 4, 4}, 1, [](int, int, int) { return 1; });
    EXPECT_THAT([&] { sample_volume(volume, lattice(2), {.seed_radius = 1e-4}); },
                ThrowsMessage<InvalidInput>(HasSubstr("more pixels per seed")));
}

TEST(Sample, RejectsAnImageOfVoid) {
    const auto volume = volume_of({4, 4, 4}, 1, [](int, int, int) { return 0; });
    EXPECT_THAT([&] { sample_volume(volume, lattice(2), {.seed_radius = 1}); },
                ThrowsMessage<InvalidInput>(HasSubstr("in void")));
}

TEST(Labels, OfTheImageAndTheUserMustAgree) {
    const std::map<std::int32_t, std::int64_t> image{{0, 5}, {1, 10}, {2, 3}};
    EXPECT_NO_THROW(check_labels(image, {}, {}));
    EXPECT_NO_THROW(check_labels(image, {{1, "a"}, {2, "b"}}, {2}));
    EXPECT_NO_THROW(check_labels(image, {{0, "void"}, {1, "a"}, {2, "b"}}, {}));
    const auto refused = [&](const std::map<std::int32_t, std::string>& names, const std::vector<std::int32_t>& objects,
                             const std::string& part) {
        EXPECT_THAT([&] { check_labels(image, names, objects); }, ThrowsMessage<InvalidInput>(HasSubstr(part)));
    };
    refused({{1, "a"}}, {}, "label 2 (3 voxels)");
    refused({{1, "a"}, {2, "b"}, {3, "c"}}, {}, "label 3 (c)");
    refused({{0, "a"}, {1, "b"}, {2, "c"}}, {}, "label 0 is void");
    refused({}, {0}, "label 0 is void");
    refused({}, {4}, "does not have label 4");
}

TEST(Phases, AreComparedInPointsAndMissingOnesNamed) {
    Sample sample;
    sample.candidates = 100;
    sample.labelled = {{0, 50}, {1, 50}};
    const std::map<std::int32_t, std::int64_t> image{{0, 400}, {1, 590}, {2, 10}};
    const auto phases = compare_phases(image, image, sample, {{1, "a"}, {2, "b"}});
    ASSERT_EQ(phases.size(), 3U);
    EXPECT_NEAR(phases[0].difference(), 10, 1e-12);
    EXPECT_NEAR(phases[1].difference(), -9, 1e-12);
    EXPECT_THAT([&] { check_phases(phases); },
                ThrowsMessage<InvalidInput>(HasSubstr("label 2 (b) has 10 voxels but no particle")));
}

}  // namespace
}  // namespace tomodem::vol2pack
