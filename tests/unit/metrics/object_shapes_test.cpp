#include "tools/metrics/object_shapes.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "core/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

double shape_factor_of(const std::vector<Vec3>& centres) {
    std::vector<std::size_t> all(centres.size());
    std::iota(all.begin(), all.end(), 0);
    return shape_factor(second_moments(centres, all));
}

TEST(ShapeFactor, TakesTheHeightAlongTheLoadAxis) {
    const Vec3 moments(9, 1, 4);
    EXPECT_DOUBLE_EQ(shape_factor(moments, 2), 2 / 2.0);
    EXPECT_DOUBLE_EQ(shape_factor(moments, 0), 3 / 1.5);
    EXPECT_DOUBLE_EQ(shape_factor(moments, 1), 1 / 2.5);
    EXPECT_DOUBLE_EQ(shape_factor(moments), shape_factor(moments, 2));
}

TEST(ShapeFactor, OfAnEllipsoidIsItsHeightOverItsMeanWidth) {
    const std::vector<Vec3> centres = synthetic::ellipsoid({4.0, 6.0, 3.0}, 0.2, {7, 8, 9});
    ASSERT_GT(centres.size(), 30000u);
    EXPECT_NEAR(shape_factor_of(centres), 3.0 / 5.0, 1e-3);
}

TEST(ShapeFactor, OfASphereIsOne) {
    EXPECT_NEAR(shape_factor_of(synthetic::ellipsoid({5, 5, 5}, 0.2)), 1.0, 1e-3);
}

TEST(ShapeFactor, FollowsAnIsochoricCompressionExactly) {
    const std::vector<Vec3> sphere = synthetic::ellipsoid({5, 5, 5}, 0.5);
    EXPECT_NEAR(shape_factor_of(synthetic::deformed(sphere, -0.3)) / shape_factor_of(sphere), std::exp(-0.45), 1e-12);
}

TEST(SecondMoments, OfAnEllipsoidAreAFifthOfTheSquaredAxes) {
    const std::vector<Vec3> centres = synthetic::ellipsoid({4.0, 6.0, 3.0}, 0.2);
    std::vector<std::size_t> all(centres.size());
    std::iota(all.begin(), all.end(), 0);
    const Vec3 moments = second_moments(centres, all);
    EXPECT_NEAR(moments.x(), 16.0 / 5.0, 0.02);
    EXPECT_NEAR(moments.y(), 36.0 / 5.0, 0.02);
    EXPECT_NEAR(moments.z(), 9.0 / 5.0, 0.02);
}

/// A block of matrix with three objects: one inside, one at a face, one of 8 particles.
Packing block_with_objects() {
    Packing packing = synthetic::sample(synthetic::cube(20, 1.0));
    synthetic::add_object(packing, synthetic::cube(3, 0.5, {8, 8, 8}), 1);
    synthetic::add_object(packing, synthetic::cube(3, 0.5, {8, 8, 0.5}), 2);
    synthetic::add_object(packing, synthetic::cube(1, 0.5, {12, 12, 12}), 5);
    return packing;
}

TEST(ChooseObjects, LeavesOutThoseTooSmall) {
    const ChosenObjects objects = choose_objects(block_with_objects(), {});
    ASSERT_EQ(objects.used.size(), 2u);
    EXPECT_EQ(objects.used[0].number, 1);
    EXPECT_EQ(objects.used[0].species, 2);
    EXPECT_EQ(objects.used[0].members.size(), 64u);
    EXPECT_EQ(objects.used[1].number, 2);
    EXPECT_EQ(objects.too_small, 1u);
    EXPECT_EQ(objects.at_boundary, 0u);
}

TEST(ChooseObjects, LeavesOutThoseAtTheFaceOfTheSample) {
    const ChosenObjects objects = choose_objects(block_with_objects(), {.min_particles = 20, .exclude_boundary = true});
    ASSERT_EQ(objects.used.size(), 1u);
    EXPECT_EQ(objects.used[0].number, 1);
    EXPECT_EQ(objects.at_boundary, 1u);
}

TEST(ChooseObjects, LeavesOutThoseAtTheBoxWhereTheSampleBulgesBeyondIt) {
    Packing packing = block_with_objects();
    packing.box.origin = {8.5, 0, 0};
    const ChosenObjects objects = choose_objects(packing, {.min_particles = 8, .exclude_boundary = true});
    ASSERT_EQ(objects.used.size(), 1u);
    EXPECT_EQ(objects.used[0].number, 5);
}

TEST(ChooseObjects, LeavesOutAFlatObject) {
    Packing packing = block_with_objects();
    std::vector<Vec3> sheet = synthetic::cube(5, 0.5, {3, 3, 3});
    std::erase_if(sheet, [](const Vec3& p) { return p.z() != 3.0; });
    synthetic::add_object(packing, sheet, 9);
    EXPECT_EQ(choose_objects(packing, {}).too_small, 2u);
}

TEST(ChooseObjects, RejectsASampleWithoutObjects) {
    EXPECT_THAT([] { choose_objects(synthetic::sample(synthetic::cube(3, 1.0)), {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("'objects = true'")));
}

TEST(ChooseObjects, RejectsAChoiceThatLeavesNone) {
    EXPECT_THAT([] { choose_objects(block_with_objects(), {.min_particles = 65}); },
                ThrowsMessage<InvalidInput>(HasSubstr("the largest has 64")));
}

TEST(Spread, OfOneTwoAndThree) {
    const std::vector<double> values{1, 2, 3}, weights{1, 1, 2};
    const Spread plain = plain_spread(values);
    EXPECT_DOUBLE_EQ(plain.mean, 2.0);
    EXPECT_DOUBLE_EQ(*plain.deviation, 1.0);
    const Spread weighted = weighted_spread(values, weights);
    EXPECT_DOUBLE_EQ(weighted.mean, 2.25);
    EXPECT_DOUBLE_EQ(*weighted.deviation, std::sqrt((1.5625 + 0.0625 + 2 * 0.5625) / 4.0));
}

TEST(Spread, OfOneObjectHasNoDeviation) {
    EXPECT_FALSE(plain_spread(std::vector{1.0}).deviation.has_value());
    EXPECT_FALSE(weighted_spread(std::vector{1.0}, std::vector{3.0}).deviation.has_value());
}

}  // namespace
}  // namespace tomodem
