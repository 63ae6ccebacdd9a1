#include "core/packing.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace tomodem {
namespace {

TEST(Packing, DensityOfOneSphereInItsCubeIsPiOverSix) {
    Packing packing;
    packing.box.edges = {3.0, 3.0, 3.0};
    packing.seed_radius = 1.5;
    packing.position = {Vec3::Zero()};
    EXPECT_DOUBLE_EQ(packing.density(), std::numbers::pi / 6.0);
}

}  // namespace
}  // namespace tomodem
