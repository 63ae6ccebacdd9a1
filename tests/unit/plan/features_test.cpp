#include "tools/plan/features.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/error.hpp"
#include "tests/unit/plan/drawn.hpp"

namespace tomodem::plan {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const Scene one_phase = parse_scene(drawn::one_phase, "one.toml");
const Scene two_phases = parse_scene(drawn::two_phases, "two.toml");

TEST(Features, OfBallsAreTheirDiameters) {
    const ImageFeatures found = find_features(drawn::balls({12, 12, 12, 6}, 2), two_phases, 1);
    ASSERT_EQ(found.features.size(), 1);
    const Feature& balls = found.features[0];
    EXPECT_EQ(balls.kind, Feature::Kind::objects);
    EXPECT_EQ(balls.of, "b");
    EXPECT_EQ(balls.count, 4);
    EXPECT_NEAR(balls.median, 0.24, 0.002);
    EXPECT_NEAR(balls.smallest, 0.12, 0.002);
    EXPECT_NEAR(found.solid_volume, 0.216, 1e-9);
    EXPECT_TRUE(found.voids.empty());
}

TEST(Features, WithoutMarkedObjectsAreThoseOfAllButTheLargestPhase) {
    std::string text = drawn::two_phases;
    text.erase(text.find("objects = true\n"), 15);
    const ImageFeatures found = find_features(drawn::balls({10}, 2), parse_scene(text, "two.toml"), 1);
    ASSERT_EQ(found.features.size(), 1);
    EXPECT_EQ(found.features[0].of, "b");
}

TEST(Features, LeaveSpecksOut) {
    const ImageFeatures found = find_features(drawn::balls({12, 1.5}, 2), two_phases, 1);
    EXPECT_EQ(found.features.at(0).count, 1);
}

TEST(Features, OfClosedPoresAreTheirDiameters) {
    const ImageFeatures found = find_features(drawn::balls({8, 8, 8}, 0), one_phase, 1);
    ASSERT_EQ(found.features.size(), 1);
    EXPECT_EQ(found.features[0].kind, Feature::Kind::pores);
    EXPECT_EQ(found.features[0].count, 3);
    EXPECT_NEAR(found.features[0].median, 0.16, 0.002);
    EXPECT_EQ(found.voids.size(), 3);
}

TEST(Features, VoidThatReachesAFaceIsNoPore) {
    const ImageFeatures found =
        find_features(drawn::volume(40, [](const Vec3& at) { return at[0] < 4 ? 0 : 1; }), one_phase, 1);
    EXPECT_TRUE(found.features.empty());
}

TEST(Features, OfAScaffoldOfRodsAreTheDiametersOfTheRods) {
    // Rods of radius 5 along the three axes, 30 apart.
    const ImageFeatures found =
        find_features(drawn::volume(90,
                                    [](const Vec3& at) {
                                        const Vec3 off = at - 30 * ((at.array() / 30).floor() + 0.5).matrix();
                                        for (int axis = 0; axis < 3; ++axis)
                                            if (std::hypot(off[axis], off[(axis + 1) % 3]) < 5) return 1;
                                        return 0;
                                    }),
                      one_phase, 1);
    ASSERT_EQ(found.features.size(), 1);
    EXPECT_EQ(found.features[0].kind, Feature::Kind::struts);
    EXPECT_NEAR(found.features[0].median, 0.10, 0.01);
}

TEST(Features, OfAPoreKnowItsDistanceFromTheFaces) {
    // 0.01 mm a voxel; a pore of 11 voxels whose first one is the sixth.
    const ImageFeatures found = find_features(
        drawn::volume(40, [](const Vec3& at) { return (at - Vec3(10.5, 20, 20)).norm() < 5.5 ? 0 : 1; }), one_phase, 1);
    ASSERT_EQ(found.voids.size(), 1);
    EXPECT_NEAR(found.voids[0].wall(), 5 * drawn::voxel, 1e-9);
}

TEST(Features, MedianIsThatOfTheVolume) {
    EXPECT_EQ(median_by_volume({1, 1, 1, 1, 1, 1, 1, 2}), 2);
    EXPECT_EQ(median_by_volume({1, 1, 1, 1, 1, 1, 1, 1, 1, 2}), 1);
}

TEST(Features, RejectALabelThatTheSceneDoesNotName) {
    EXPECT_THAT([] { find_features(drawn::balls({8}, 2), one_phase, 1); },
                ThrowsMessage<InvalidInput>(HasSubstr("no phase with label 2, which the image has")));
}

TEST(Features, RejectAPhaseThatTheImageDoesNotHave) {
    EXPECT_THAT([] { find_features(drawn::balls({}, 2, 20), two_phases, 1); },
                ThrowsMessage<InvalidInput>(HasSubstr("line 5: [phase.b] has label 2, which the image does not have")));
}

}  // namespace
}  // namespace tomodem::plan
