#include "tools/metrics/shapes/object_shapes.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"

namespace tomodem::shapes {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

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

TEST(ChooseObjects, LeavesOutAFlatObjectThatLiesAskew) {
    Packing packing = block_with_objects();
    std::vector<Vec3> sheet = synthetic::cube(5, 0.5, {3, 3, 3});
    std::erase_if(sheet, [](const Vec3& p) { return p.z() != 3.0; });
    for (Vec3& p : sheet) p = Vec3(p.x(), p.y(), 0.3 * p.x() + 0.7 * p.y());
    synthetic::add_object(packing, sheet, 9);
    EXPECT_EQ(choose_objects(packing, {}).too_small, 2u);
}

TEST(ChooseObjects, TellsThoseAtTheFaceThatItKeeps) {
    const ChosenObjects objects = choose_objects(block_with_objects(), {});
    EXPECT_FALSE(objects.used[0].at_boundary);
    EXPECT_TRUE(objects.used[1].at_boundary);
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
}  // namespace tomodem::shapes
