#include "core/volume/void_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace tomodem {
namespace {

/// 40 x 40 x 20 voxels of 0.1 x 0.1 x 0.2 mm, label 1, with void where a rule says so of a voxel's centre [mm].
std::vector<VoidPart> parts_of(const std::function<bool(const Vec3&)>& is_void) {
    LabelVolume volume({40, 40, 20}, Vec3(0.1, 0.1, 0.2), Vec3(1, 2, 3));
    std::vector<std::int32_t> labels(1600);
    for (std::int32_t k = 0; k < 20; ++k) {
        for (std::int32_t j = 0; j < 40; ++j)
            for (std::int32_t i = 0; i < 40; ++i)
                labels[std::size_t(j) * 40 + i] =
                    is_void(Vec3(0.1 * (i + 0.5), 0.1 * (j + 0.5), 0.2 * (k + 0.5))) ? 0 : 1;
        volume.set_slice(k, labels);
    }
    return void_parts(connected_components(volume, {0}));
}

auto ball(const Vec3& centre, double radius) {
    return [=](const Vec3& at) { return (at - centre).norm() < radius; };
}

TEST(VoidParts, KnowTheirPlaceSizeAndWalls) {
    const auto parts = parts_of(ball({2, 1.5, 2}, 0.8));
    ASSERT_EQ(parts.size(), 1u);
    const VoidPart& part = parts[0];
    EXPECT_NEAR((part.centre - Vec3(3, 3.5, 5)).norm(), 0, 0.02);
    EXPECT_NEAR(part.diameter(), 1.6, 0.03);
    EXPECT_NEAR(part.wall_low[1], 0.7, 0.101);
    EXPECT_NEAR(part.wall_high[1], 1.7, 0.101);
    EXPECT_NEAR(part.wall(), part.wall_low[1], 1e-12);
}

TEST(VoidParts, AreOfFourKinds) {
    const auto kind = [](const std::function<bool(const Vec3&)>& is_void, double seed_radius) {
        const auto parts = parts_of(is_void);
        EXPECT_EQ(parts.size(), 1u);
        return kind_of(parts.at(0), seed_radius);
    };
    EXPECT_EQ(kind(ball({2, 2, 2}, 0.8), 0.1), PoreKind::closed);
    EXPECT_EQ(kind(ball({2, 2, 2}, 0.8), 0.3), PoreKind::too_small);
    EXPECT_EQ(kind(ball({1.1, 2, 2}, 0.8), 0.05), PoreKind::closed);
    EXPECT_EQ(kind(ball({1.1, 2, 2}, 0.8), 0.1), PoreKind::cut);  // a wall of 0.3, particles of 0.2
    EXPECT_EQ(kind(ball({0.2, 0.2, 2}, 0.8), 0.05), PoreKind::cut);
    EXPECT_EQ(kind([](const Vec3& at) { return std::hypot(at[0] - 2, at[1] - 2) < 0.5; }, 0.05), PoreKind::open);
    EXPECT_EQ(kind(ball({2, 2, 2}, 1.7), 0.1), PoreKind::open);  // thin walls on both sides
}

}  // namespace
}  // namespace tomodem
