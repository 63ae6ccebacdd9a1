#include "core/volume/volume.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <random>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

std::vector<std::int32_t> noise(std::size_t count, int labels, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::int32_t> voxels(count);
    for (auto& voxel : voxels) voxel = static_cast<std::int32_t>(random() % labels);
    return voxels;
}

TEST(LabelVolume, GivesBackEachSliceAsItWasSet) {
    const VoxelIndex size{21, 13, 19};
    LabelVolume volume(size, Vec3::Ones());
    std::vector<std::vector<std::int32_t>> slices;
    for (int k = 0; k < size[2]; ++k) slices.push_back(noise(21 * 13, 4, k));
    for (int k : {5, 18, 0, 7, 8, 1, 2, 3, 4, 6, 9, 10, 11, 12, 13, 14, 15, 16, 17}) volume.set_slice(k, slices[k]);
    std::vector<std::int32_t> found;
    for (int k = 0; k < size[2]; ++k) {
        volume.slice(k, found);
        ASSERT_EQ(found, slices[k]) << "slice " << k;
    }
}

TEST(LabelVolume, GivesTheSameVoxelsSetBySlabsOrBySlices) {
    const VoxelIndex size{17, 9, 21};
    const auto voxels = noise(17 * 9 * 21, 3, 1);
    LabelVolume by_slab(size, Vec3::Ones());
    by_slab.set_slices(0, 8, std::span(voxels).subspan(0, 8 * 17 * 9));
    by_slab.set_slices(8, 13, std::span(voxels).subspan(8 * 17 * 9));
    LabelVolume by_odd_parts(size, Vec3::Ones());
    by_odd_parts.set_slices(3, 11, std::span(voxels).subspan(3 * 17 * 9, 11 * 17 * 9));
    by_odd_parts.set_slices(14, 7, std::span(voxels).subspan(14 * 17 * 9));
    by_odd_parts.set_slices(0, 3, std::span(voxels).subspan(0, 3 * 17 * 9));
    for (const LabelVolume* volume : {&by_slab, &by_odd_parts}) {
        std::vector<std::int32_t> found;
        volume->slices(0, size[2], found);
        EXPECT_EQ(found, voxels);
        const LabelVolume::Sampler sampler(*volume);
        EXPECT_EQ(sampler.at({16, 8, 20}), voxels.back());
        EXPECT_EQ(sampler.at({4, 7, 9}), voxels[(9 * 9 + 7) * 17 + 4]);
    }
}

TEST(LabelVolume, CanBeSetAgainOverAConstantBlock) {
    LabelVolume volume({16, 16, 16}, Vec3::Ones());
    volume.set_slices(0, 16, std::vector<std::int32_t>(16 * 16 * 16, 7));
    volume.set_slice(3, std::vector<std::int32_t>(16 * 16, 2));
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(2, 256), Pair(7, 15 * 256)));
    volume.set_slices(0, 16, std::vector<std::int32_t>(16 * 16 * 16, 0));
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(0, 4096)));
}

TEST(LabelVolume, CountsOnlyItsOwnVoxelsWhereItEndsWithinABlock) {
    LabelVolume volume({9, 10, 11}, Vec3::Ones());
    volume.set_slices(0, 11, std::vector<std::int32_t>(9 * 10 * 11, 3));
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(3, 990)));
    EXPECT_EQ(LabelVolume::Sampler(volume).at({9, 0, 0}), 0);
}

TEST(LabelVolume, TakesLittleMemoryWhereLabelsAreConstant) {
    LabelVolume volume({256, 256, 64}, Vec3::Ones());
    const std::vector<std::int32_t> slab(256 * 256 * 8, 2);
    for (int k = 0; k < 64; k += 8) volume.set_slices(k, 8, slab);
    EXPECT_LT(volume.memory(), 256 * 256 * 64 / 4) << "bytes, for 4 bytes a voxel stored one by one";
}

TEST(LabelVolume, HasNegativeLabels) {
    LabelVolume volume({2, 1, 1}, Vec3::Ones());
    volume.set_slice(0, {-5, 1});
    EXPECT_THAT(volume.histogram(), ElementsAre(Pair(-5, 1), Pair(1, 1)));
}

TEST(LabelVolume, RejectsAVoxelSizeOfZero) {
    EXPECT_THAT([] { LabelVolume({1, 1, 1}, Vec3(1, 0, 1)); }, ThrowsMessage<InvalidInput>(HasSubstr("voxel size 0")));
}

class Sampled : public testing::Test {
 protected:
    // Voxels of 2 x 2 x 4 mm; label 1 where x < 2 voxels, else 2.
    Sampled() : volume({4, 4, 4}, Vec3(2, 2, 4), Vec3(10, 20, 30)) {
        std::vector<std::int32_t> voxels;
        for (int i = 0; i < 64; ++i) voxels.push_back(i % 4 < 2 ? 1 : 2);
        volume.set_slices(0, 4, voxels);
    }
    LabelVolume volume;
};

TEST_F(Sampled, NearestIsTheVoxelThatContainsThePoint) {
    const LabelVolume::Sampler sampler(volume);
    EXPECT_EQ(sampler.nearest({10.1, 20.1, 30.1}), 1);
    EXPECT_EQ(sampler.nearest({13.99, 27.9, 45.9}), 1);
    EXPECT_EQ(sampler.nearest({14.01, 20.1, 30.1}), 2);
    EXPECT_EQ(sampler.nearest({9.99, 21, 31}), 0);
    EXPECT_EQ(sampler.nearest({11, 28.01, 31}), 0);
    EXPECT_EQ(sampler.nearest({11, 21, 46.01}), 0);
}

TEST_F(Sampled, MajorityIsTheLabelOfTheLargerPartOfTheBox) {
    const LabelVolume::Sampler sampler(volume);
    EXPECT_EQ(sampler.majority({13.9, 24, 38}, 1.5), 1);
    EXPECT_EQ(sampler.majority({14.1, 24, 38}, 1.5), 2);
}

TEST_F(Sampled, MajorityOfEqualPartsIsTheSmallerLabel) {
    EXPECT_EQ(LabelVolume::Sampler(volume).majority({14, 24, 38}, 1.3), 1);
}

TEST_F(Sampled, MajorityIgnoresWhatSticksOutOfTheVolume) {
    EXPECT_EQ(LabelVolume::Sampler(volume).majority({10.01, 20.01, 30.01}, 2), 1);
    EXPECT_EQ(LabelVolume::Sampler(volume).majority({17.99, 27.99, 45.99}, 2), 2);
}

TEST(Sampler, MajorityEqualsACountOverFineSubdivisionsOnNoise) {
    LabelVolume volume({20, 20, 20}, Vec3::Ones());
    volume.set_slices(0, 20, noise(8000, 2, 3));
    const LabelVolume::Sampler sampler(volume);
    std::mt19937 random(5);
    for (int trial = 0; trial < 50; ++trial) {
        // On quarters of a voxel the subdivision is exact.
        const auto quarter = [&](int low, int high) { return 0.25 * (low + int(random() % (high - low))); };
        const Vec3 point(quarter(12, 68), quarter(12, 68), quarter(12, 68));
        const double half = quarter(3, 12);
        std::map<std::int32_t, int> votes;
        for (double x = point[0] - half + 0.125; x < point[0] + half; x += 0.25)
            for (double y = point[1] - half + 0.125; y < point[1] + half; y += 0.25)
                for (double z = point[2] - half + 0.125; z < point[2] + half; z += 0.25)
                    ++votes[sampler.nearest({x, y, z})];
        EXPECT_EQ(sampler.majority(point, half), votes[1] > votes[0] ? 1 : 0) << "trial " << trial;
    }
}

LabelVolume body(VoxelIndex size, const Vec3& spacing, const std::function<std::int32_t(const Vec3&)>& label) {
    LabelVolume volume(size, spacing);
    std::vector<std::int32_t> voxels;
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x)
                voxels.push_back(label(Vec3(x + 0.5, y + 0.5, z + 0.5).cwiseProduct(spacing)));
    volume.set_slices(0, size[2], voxels);
    return volume;
}

/// Share of random points of the box whose label differs from that of the body itself.
template <class Look>
double wrong_share(const LabelVolume& volume, const std::function<std::int32_t(const Vec3&)>& truth, const Look& look) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform;
    int wrong = 0;
    constexpr int points = 20000;
    for (int i = 0; i < points; ++i) {
        const Vec3 point = volume.extent().cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
        wrong += look(point) != truth(point);
    }
    return double(wrong) / points;
}

TEST(LevelSet, IsNearerToASphereThanItsVoxelsAre) {
    for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(1, 0.5, 2)}) {
        const auto truth = [](const Vec3& point) { return (point - Vec3(12.3, 11.9, 12.6)).norm() < 8.3 ? 2 : 1; };
        const auto volume = body({24, int(24 / spacing[1]), int(24 / spacing[2])}, spacing, truth);
        const LabelVolume::Sampler sampler(volume);
        const double nearest = wrong_share(volume, truth, [&](const Vec3& at) { return sampler.nearest(at); });
        const double smooth = wrong_share(volume, truth, [&](const Vec3& at) { return sampler.level_set(at, 0.8); });
        EXPECT_LT(smooth, 0.6 * nearest) << spacing.transpose();
    }
}

TEST(LevelSet, KeepsTheVolumeOfASphereWhereAGaussianWouldShrinkIt) {
    // A Gaussian of 1.5 voxels moves the interface by 1.5^2 / 10 voxels: 6.7 % of the volume.
    const auto volume = body({30, 30, 30}, Vec3::Ones(),
                             [](const Vec3& point) { return (point - Vec3(15.2, 14.7, 15.4)).norm() < 10 ? 2 : 1; });
    const LabelVolume::Sampler sampler(volume);
    std::int64_t inside = 0;
    for (int z = 0; z < 60; ++z)
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 60; ++x) {
                const Vec3 at = 0.5 * Vec3(x + 0.5, y + 0.5, z + 0.5);
                const double radius = (at - Vec3(15.2, 14.7, 15.4)).norm();
                inside += radius < 8 || (radius < 12 && sampler.level_set(at, 1.5) == 2);
            }
    // The kernel's next moment leaves a quarter of that.
    EXPECT_NEAR(static_cast<double>(inside) / 8 / (4.0 / 3 * M_PI * 1000), 1, 0.02);
}

TEST(LevelSet, HoldsAFlatInterfaceAtAnyDirectionOfTheFaces) {
    // Up to the faces of the volume, where half of the neighbourhood is missing.
    const auto volume = body({20, 20, 20}, Vec3::Ones(), [](const Vec3& point) { return point[1] < 9 ? 1 : 2; });
    const LabelVolume::Sampler sampler(volume);
    for (const double x : {0.01, 0.6, 10.3, 19.99})
        for (const double z : {0.01, 7.4, 19.99}) {
            EXPECT_EQ(sampler.level_set({x, 8.98, z}, 0.8), 1);
            EXPECT_EQ(sampler.level_set({x, 9.02, z}, 0.8), 2);
        }
    EXPECT_EQ(sampler.level_set({10, 0.01, 10}, 2), 1);
    EXPECT_EQ(sampler.level_set({10, 19.99, 10}, 2), 2);
    EXPECT_EQ(sampler.level_set({10, 20.01, 10}, 2), 0);
}

TEST(LevelSet, KeepsTheLabelAtTheCentreOfEveryVoxelOfAWireAPlateAndASpeck) {
    for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(1, 1, 20)})
        for (const double width : {0.5, 0.8, 2.0}) {
            const auto truth = [&](const Vec3& at) {
                const Vec3 voxel = at.cwiseQuotient(spacing).array().floor();
                if (voxel[0] == 5 && voxel[1] == 5) return 1;  // a wire along z
                if (voxel[2] == 12) return 2;                  // a plate
                return voxel == Vec3(15, 15, 5) ? 3 : 0;       // a speck
            };
            const auto volume = body({20, 20, 20}, spacing, truth);
            const LabelVolume::Sampler sampler(volume);
            for (int z = 0; z < 20; ++z)
                for (int y = 0; y < 20; ++y)
                    for (int x = 0; x < 20; ++x) {
                        const Vec3 centre = Vec3(x + 0.5, y + 0.5, z + 0.5).cwiseProduct(spacing);
                        ASSERT_EQ(sampler.level_set(centre, width), truth(centre)) << centre.transpose();
                    }
        }
}

TEST(LevelSet, DividesThreeLabelsWithoutGapsOrPreference) {
    // Three sectors of 120 degrees about z; as in the image, none grows and no fourth appears.
    const auto truth = [](const Vec3& at) {
        const double angle = std::atan2(at[1] - 20, at[0] - 19.7) + M_PI;
        return 1 + std::min(2, static_cast<int>(angle / (2 * M_PI / 3)));
    };
    const auto volume = body({40, 40, 6}, Vec3::Ones(), truth);
    const LabelVolume::Sampler sampler(volume);
    std::map<std::int32_t, int> smooth, exact;
    for (int y = 0; y < 160; ++y)
        for (int x = 0; x < 160; ++x) {
            const Vec3 at(0.25 * (x + 0.5), 0.25 * (y + 0.5), 3.1);
            ++smooth[sampler.level_set(at, 0.8)];
            ++exact[truth(at)];
        }
    ASSERT_EQ(smooth.size(), 3U);
    for (const auto& [label, count] : exact) EXPECT_NEAR(smooth[label], count, 0.006 * count) << label;
}

TEST(LevelSet, OfOneVoxelIsThatVoxel) {
    LabelVolume volume({1, 1, 1}, Vec3::Ones());
    volume.set_slice(0, {7});
    EXPECT_EQ(LabelVolume::Sampler(volume).level_set({0.9, 0.1, 0.5}, 0.8), 7);
    LabelVolume line({1, 1, 4}, Vec3::Ones());
    line.set_slices(0, 4, std::vector<std::int32_t>{1, 1, 70000, 70000});
    EXPECT_EQ(LabelVolume::Sampler(line).level_set({0.9, 0.1, 1.9}, 0.8), 1);
    EXPECT_EQ(LabelVolume::Sampler(line).level_set({0.9, 0.1, 2.1}, 0.8), 70000);
}

}  // namespace
}  // namespace tomodem
