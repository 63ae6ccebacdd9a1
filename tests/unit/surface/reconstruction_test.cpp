#include "core/surface/reconstruction.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Packing two_cubes_and_a_pair() {
    Packing packing = synthetic::sample(synthetic::cube(9, 1.0));
    synthetic::add_object(packing, synthetic::cube(2, 0.5, {1, 1, 1}), 4);
    synthetic::add_object(packing, synthetic::cube(4, 0.5, {5, 5, 5}), 7);
    synthetic::add_object(packing, {{3, 3, 7}, {3.5, 3, 7}}, 9);
    return packing;
}

TEST(Reconstruction, OfEachObjectHasARowForEveryOneThatEnclosesAVolume) {
    const Reconstruction result = reconstruct(two_cubes_and_a_pair(), {.bodies = Bodies::objects, .probe_radius = 0.5});
    ASSERT_EQ(result.rows.size(), 2u);
    EXPECT_EQ(result.rows[0].object, 4);
    EXPECT_EQ(result.rows[1].object, 7);
    EXPECT_NEAR(result.rows[0].body.volume, 1.0, 1e-12);
    EXPECT_NEAR(result.rows[1].body.volume, 8.0, 1e-12);
    EXPECT_EQ(result.objects_left_out, 1);
    EXPECT_NEAR(result.mesh.volume(), 9.0, 1e-12);
    EXPECT_EQ(result.object_of_triangle.front(), 4);
    EXPECT_EQ(result.body_of_triangle.back(), 2);
}

TEST(Reconstruction, OfObjectsRejectsASampleWithoutAny) {
    EXPECT_THAT([] { reconstruct(synthetic::sample(synthetic::cube(3, 1.0)), {.bodies = Bodies::objects}); },
                ThrowsMessage<InvalidInput>(HasSubstr("no objects in the sample")));
}

TEST(Reconstruction, RejectsAProbeLargerThanTheSample) {
    EXPECT_THAT([] { reconstruct(synthetic::sample(synthetic::cube(3, 1.0)), {.probe_radius = 6.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("larger than the particles to wrap")));
}

}  // namespace
}  // namespace tomodem
