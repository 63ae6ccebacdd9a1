#include "core/volume.hpp"

#include <gmock/gmock.h>

#include <random>

#include "core/error.hpp"

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

}  // namespace
}  // namespace tomodem
