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

TEST(Features, OfPoresThatFacesCutCountWhereNoneIsClosed) {
    const auto balls = [](bool closed) {
        return drawn::volume(40, [=](const Vec3& at) {
            return (at - Vec3(0, 20, 20)).norm() < 9 || (closed && (at - Vec3(28, 20, 20)).norm() < 6) ? 0 : 1;
        });
    };
    EXPECT_NEAR(find_features(balls(false), one_phase, 1).features.at(0).median, 0.18 / std::cbrt(2), 0.003);
    EXPECT_NEAR(find_features(balls(true), one_phase, 1).features.at(0).median, 0.12, 0.003);
}

TEST(Features, VoidThatPassesThroughIsNoPore) {
    const ImageFeatures found =
        find_features(drawn::volume(40, [](const Vec3& at) { return at[0] < 4 ? 0 : 1; }), one_phase, 1);
    EXPECT_TRUE(found.features.empty());
}

TEST(Features, OfAScaffoldOfRodsAreTheDiametersOfTheRods) {
    const ImageFeatures found = find_features(drawn::foam_with_pores(0), one_phase, 1);
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

/// A row of three balls that touch, of radius 9, in void.
LabelVolume touching() {
    return drawn::volume(60, [](const Vec3& at) {
        for (const double x : {13.0, 30.0, 47.0})
            if ((at - Vec3(x, 30, 30)).norm() < 9) return 1;
        return 0;
    });
}

TEST(Features, OfObjectsThatTouchSayThatTheyAreOneTangledPart) {
    std::string text = drawn::one_phase;
    text.insert(text.find("norton"), "objects = true\n");
    const Scene scene = parse_scene(text, "one.toml");
    LabelVolume many = drawn::volume(80, [](const Vec3& at) {  // 5 x 5 x 5 that touch
        const Vec3 off = at - 16 * ((at.array() / 16).floor() + 0.5).matrix();
        return off.norm() < 8.6 ? 1 : 0;
    });
    const ImageFeatures found = find_features(many, scene, 1);
    EXPECT_EQ(found.features.at(0).count, 1);
    EXPECT_TRUE(found.features[0].tangled);
    EXPECT_NEAR(found.features[0].median, 0.16, 0.015);
    const LabelVolume one =
        drawn::volume(60, [](const Vec3& at) { return (at - Vec3::Constant(30)).norm() < 20 ? 1 : 0; });
    EXPECT_FALSE(find_features(one, scene, 1).features.at(0).tangled);
}

TEST(Features, OfObjectsToBeSeparatedAreTheThicknessOfTheirPhase) {
    std::string text = drawn::one_phase;
    text.insert(text.find("norton"), "objects = true\n");
    const ImageFeatures found = find_features(touching(), parse_scene(text, "one.toml"), 1, ObjectsBy::watershed);
    EXPECT_EQ(found.features.at(0).count, 0);
    EXPECT_NEAR(found.features[0].median, 0.18, 0.02);
}

TEST(Features, OfObjectsWithLabelsAreTheirDiameters) {
    LabelVolume volume = drawn::volume(60, [](const Vec3& at) {
        const int column = int(at[0] / 20), row = int(at[1] / 20);
        return (at - Vec3(20 * column + 10, 20 * row + 10, 30)).norm() < 8 ? 100 + column + 3 * row : 2;
    });
    EXPECT_TRUE(looks_labelled(volume));
    std::string text = drawn::two_phases;  // a = 1, b = 2 with objects; here 1 has the labels
    text.erase(text.find("objects = true\n"), 15);
    text.insert(text.find("norton"), "objects = true\n");
    const Scene scene = parse_scene(text, "two.toml");
    const LabelledObjects objects = take_labels(volume, phase_of_objects(scene), {2});
    EXPECT_EQ(vol2pack_options(ObjectsBy::labels, {}, objects.ranges), "--label-objects 100:108=1");
    const ImageFeatures found = find_features(volume, scene, 1, ObjectsBy::labels, &objects);
    EXPECT_EQ(found.features.at(0).count, 9);
    EXPECT_NEAR(found.features[0].median, 0.16, 0.003);
    EXPECT_THAT(found.labels, testing::ElementsAre(1, 2));
}

TEST(Objects, OfLabelsLeaveOtherPhasesOut) {
    LabelVolume volume = drawn::volume(20, [](const Vec3& at) { return int(at[2]); });  // 0 .. 19
    const auto ranges = take_labels(volume, 7, {7, 12}).ranges;
    EXPECT_EQ(vol2pack_options(ObjectsBy::labels, {}, ranges), "--label-objects 1:6=7,8:11=7,13:19=7");
    EXPECT_EQ(volume.histogram().size(), 3u);
    EXPECT_THAT(
        [&] {
            take_labels(volume, 3, {7, 12});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("no label that is not")));
}

TEST(Objects, OfAWatershedAreAboveTheLabelsThatItKeeps) {
    EXPECT_EQ(vol2pack_options(ObjectsBy::watershed, {}, {separated_range({1, 2}, 1)}), "--label-objects 3:99999999=1");
    EXPECT_EQ(vol2pack_options(ObjectsBy::watershed, {}, {separated_range({1}, 1)}), "--label-objects 1:99999999=1");
}

TEST(Objects, NoiseDoesNotLookLabelled) {
    std::uint32_t state = 1;
    EXPECT_FALSE(looks_labelled(drawn::volume(30, [&](const Vec3&) {
        state = state * 1664525U + 1013904223U;
        return int(state >> 24);
    })));
}

}  // namespace
}  // namespace tomodem::plan
