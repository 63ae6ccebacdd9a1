#include "tools/relax/pores.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/base/error.hpp"
#include "tests/unit/relax/images.hpp"

namespace tomodem::relax {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(SquaredDistances, AreThoseOfAllPairsOnUnequalSpacings) {
    const VoxelIndex size{9, 7, 8};
    const Vec3 spacing(1.0, 2.5, 0.4);
    std::mt19937_64 random(3);
    std::vector<bool> set(9 * 7 * 8);
    for (std::size_t i = 0; i < set.size(); ++i) set[i] = random() % 40 == 0;
    const std::vector<float> found = squared_distances(set, size, spacing);
    const auto point = [&](std::size_t i) -> Vec3 {
        const std::size_t row = i / 9, layer = row / 7;
        return spacing.cwiseProduct(Vec3(double(i % 9), double(row % 7), double(layer)));
    };
    for (std::size_t i = 0; i < set.size(); ++i) {
        double nearest = 1e300;
        for (std::size_t j = 0; j < set.size(); ++j)
            if (set[j]) nearest = std::min(nearest, (point(i) - point(j)).squaredNorm());
        EXPECT_NEAR(found[i], nearest, 1e-5 * (1 + nearest)) << i;
    }
}

TEST(SquaredDistances, OfAnEmptySetAreInfinite) {
    const std::vector<float> found = squared_distances(std::vector<bool>(8), {2, 2, 2}, Vec3::Ones());
    for (const float distance : found) EXPECT_TRUE(std::isinf(distance));
}

TEST(FindPores, GivesTheDistanceToASphere) {
    const Vec3 centre(3.1, 2.9, 3.0);
    const LabelVolume image =
        image_of({60, 60, 30}, {0.1, 0.1, 0.2}, Vec3::Zero(), [&](const Vec3& p) { return (p - centre).norm() < 1.5; });
    const ImagePores found = find_pores(image, 0.1, 3, 1.0, 2);
    ASSERT_EQ(found.pores.size(), 1u);
    const ImagePore& pore = found.pores[0];
    EXPECT_EQ(pore.kind, PoreKind::closed);
    EXPECT_NEAR(pore.part.volume, 4.0 / 3 * std::numbers::pi * std::pow(1.5, 3), 0.1);
    EXPECT_NEAR(pore.across, 15, 0.05);
    EXPECT_NEAR((pore.part.centre - centre).norm(), 0, 0.01);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 1000; ++k) {
        const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
        for (const double radius : {0.5, 1.2, 1.5, 1.8, 2.3})
            EXPECT_NEAR(pore.distance.at(centre + radius * direction), radius - 1.5, 0.15);
    }
    EXPECT_TRUE(std::isinf(pore.distance.at(Vec3(30, 3, 3))));
}

TEST(FindPores, TellsCutPoresAndLeavesSmallOnesOut) {
    const LabelVolume image = image_of({60, 60, 60}, Vec3::Constant(0.1), Vec3(1, 1, 1), [](const Vec3& p) {
        return (p - Vec3(1, 4, 4)).norm() < 1 || (p - Vec3(4, 4, 4)).norm() < 0.9 || (p - Vec3(6, 6, 6)).norm() < 0.2;
    });
    const ImagePores found = find_pores(image, 0.1, 3, 0.5, 1);
    ASSERT_EQ(found.pores.size(), 2u);
    const bool first_is_cut = found.pores[0].kind == PoreKind::cut;
    EXPECT_EQ(found.pores[first_is_cut ? 1 : 0].kind, PoreKind::closed);
    EXPECT_EQ(found.too_small, 1);
    EXPECT_NEAR(found.too_small_volume, 0.0335, 0.005);
    const ImagePore& cut = found.pores[first_is_cut ? 0 : 1];
    EXPECT_EQ(cut.kind, PoreKind::cut);
    EXPECT_EQ(cut.face, (std::array<int, 3>{-1, 0, 0}));
    const double cap = std::numbers::pi / 3 * 0.25 * (3 - 0.5);  // half a radius high
    EXPECT_NEAR(cut.distance.volume_up_to(cut.face, Vec3(1.5, 9, 9)), cap, 0.02);
    const double beyond = 0.3 * std::numbers::pi;  // the image ends at 1, the material at 0.7
    EXPECT_NEAR(cut.distance.volume_up_to(cut.face, Vec3(0.7, 9, 9)), cut.part.volume + beyond, 0.04);
    // What the image does not show is not material: no surface at its face.
    EXPECT_NEAR(cut.distance.at(Vec3(1.05, 4.0, 4.0)), -1, 0.15);
}

TEST(FindPores, RefusesAnImageWithoutPores) {
    const LabelVolume image = image_of({8, 8, 8}, Vec3::Ones(), Vec3::Zero(), [](const Vec3&) { return false; });
    EXPECT_THAT([&] { find_pores(image, 0.5, 4, 1, 1); }, ThrowsMessage<InvalidInput>(HasSubstr("has no pore")));
}

TEST(FindPores, RefusesPoresThatNoParticleShows) {
    const LabelVolume image = image_of({20, 20, 20}, Vec3::Ones(), Vec3::Zero(),
                                       [](const Vec3& p) { return (p - Vec3(10, 10, 10)).norm() < 4; });
    EXPECT_THAT([&] { find_pores(image, 2, 4, 1, 1); },
                ThrowsMessage<InvalidInput>(HasSubstr("the largest of 1 is 2 particles across, 4 are needed")));
}

}  // namespace
}  // namespace tomodem::relax
