#include "core/packing/packing.hpp"

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

TEST(Packing, DensityOfSpheresWithRadiiOfTheirOwnIsThatOfTheirVolumes) {
    Packing packing;
    packing.box.edges = {2.0, 3.0, 4.0};
    packing.seed_radius = 1.0;
    packing.position = {Vec3::Zero(), Vec3::Zero()};
    packing.radius = {0.5, 1.5};
    EXPECT_DOUBLE_EQ(packing.density(), 4.0 / 3.0 * std::numbers::pi * (0.125 + 3.375) / 24.0);
    EXPECT_EQ(packing.radius_of(1), 1.5);
    packing.radius.clear();
    EXPECT_EQ(packing.radius_of(1), 1.0);
}

}  // namespace
}  // namespace tomodem
