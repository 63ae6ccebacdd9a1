#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "tools/phantom/foam.hpp"
#include "tools/phantom/grains.hpp"

namespace tomodem::phantom {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

double total_volume(const std::vector<Grain>& grains) {
    double volume = 0;
    for (const Grain& grain : grains) volume += grain_volume(grain);
    return volume;
}

TEST(GrainVolume, OfTwoOverlappingSpheresIsTheirSumLessTheLens) {
    const double r = 1.3, d = 1.1;
    const Grain pair{{{Vec3(4, 5, 6), r}, {Vec3(4, 5, 6) + d * Vec3(1, 2, 2) / 3, r}}};
    const double lens = std::numbers::pi * (4 * r + d) * std::pow(2 * r - d, 2) / 12;
    EXPECT_NEAR(grain_volume(pair) / (2 * pair.spheres[0].volume() - lens), 1, 1e-4);
}

TEST(GrainVolume, OfASphereInASphereIsTheLarger) {
    const Grain nested{{{Vec3::Zero(), 1.0}, {Vec3(0.2, 0, 0), 0.5}}};
    EXPECT_NEAR(grain_volume(nested) / nested.spheres[0].volume(), 1, 1e-4);
}

TEST(Inclusions, MeetTheFractionExactly) {
    Random random(3);
    const auto equal = draw_inclusions({.fraction = 0.2, .count = 17, .diameter = {}}, 5.0, random);
    EXPECT_EQ(equal.size(), 17U);
    EXPECT_NEAR(total_volume(equal), 1.0, 1e-12);
    const auto mixed = draw_inclusions({.fraction = 0.2, .count = {}, .diameter = {{0.1, 0.2}}}, 5.0, random);
    EXPECT_NEAR(total_volume(mixed), 1.0, 1e-12);
    for (const Grain& grain : mixed) {
        EXPECT_GT(grain.spheres[0].radius, 0.049);
        EXPECT_LT(grain.spheres[0].radius, 0.101);
    }
}

TEST(Inclusions, NeedTwoOfTheThreeNumbers) {
    Random random(3);
    EXPECT_THAT([&] { draw_inclusions({.fraction = 0.2, .count = {}, .diameter = {}}, 1, random); },
                ThrowsMessage<WrongUsage>(HasSubstr("two of")));
    EXPECT_THAT(
        [&] {
            draw_inclusions({.fraction = 0.2, .count = 3, .diameter = {{1, 2}}}, 1, random);
        },
        ThrowsMessage<WrongUsage>(HasSubstr("two of")));
}

TEST(Inclusions, LargerThanTheFractionAreRejected) {
    Random random(3);
    EXPECT_THAT(
        [&] {
            draw_inclusions({.fraction = 0.01, .count = {}, .diameter = {{0.9, 0.9}}}, 1, random);
        },
        ThrowsMessage<InvalidInput>(HasSubstr("already more than the fraction")));
}

TEST(Pores, HaveALogNormalDiameterAndTheWantedShareOfClusters) {
    Random random(11);
    const double median = 0.05, spread = 0.3;
    const auto pores =
        draw_pores({.porosity = 0.05, .median_diameter = median, .spread = spread, .cluster_share = 0.25}, 5.0, random);
    EXPECT_NEAR(total_volume(pores), 0.25, 1e-5);
    double sum = 0, squares = 0, clusters = 0;
    for (const Grain& pore : pores) {
        const double logarithm = std::log(2 * std::cbrt(grain_volume(pore) * 3 / (4 * std::numbers::pi)) / median);
        sum += logarithm;
        squares += logarithm * logarithm;
        clusters += pore.spheres.size() > 1;
    }
    const auto count = static_cast<double>(pores.size());
    EXPECT_GT(count, 500);
    EXPECT_NEAR(sum / count, 0, 0.04);
    EXPECT_NEAR(std::sqrt(squares / count), spread, 0.03);
    EXPECT_NEAR(clusters / count, 0.25, 0.06);
}

class Placing : public testing::Test {
 protected:
    static void expect_free(const std::vector<Grain>& grains, const Vec3& edges, double gap) {
        for (std::size_t i = 0; i < grains.size(); ++i)
            for (const Sphere& a : grains[i].spheres) {
                EXPECT_GE((a.centre.array() - a.radius).minCoeff(), gap - 1e-12);
                EXPECT_LE((a.centre - edges).maxCoeff() + a.radius, -gap + 1e-12);
                for (std::size_t j = 0; j < i; ++j)
                    for (const Sphere& b : grains[j].spheres)
                        ASSERT_GE((a.centre - b.centre).norm() - a.radius - b.radius, gap - 1e-12) << i << " and " << j;
            }
    }
};

TEST_F(Placing, LeavesTheGapBetweenGrainsAndToTheFaces) {
    Random random(1);
    const Vec3 edges(1, 1.5, 2);
    const auto drawn = draw_pores({.porosity = 0.1, .median_diameter = 0.12, .spread = 0.4, .cluster_share = 0.5},
                                  edges.prod(), random);
    expect_free(place_without_overlap(drawn, edges, 0.02, random), edges, 0.02);
}

TEST_F(Placing, PushesDenseInclusionsApart) {
    Random random(1);
    const Vec3 edges = Vec3::Ones();
    const auto drawn = draw_inclusions({.fraction = 0.42, .count = 300, .diameter = {}}, 1, random);
    expect_free(place_without_overlap(drawn, edges, 0, random), edges, 0);
}

TEST_F(Placing, RejectsWhatCannotFit) {
    Random random(1);
    const auto dense = draw_inclusions({.fraction = 0.8, .count = 60, .diameter = {}}, 1, random);
    EXPECT_THAT([&] { place_without_overlap(dense, Vec3::Ones(), 0, random); },
                ThrowsMessage<InvalidInput>(HasSubstr("do not fit")));
    const auto large = draw_inclusions({.fraction = {}, .count = 1, .diameter = {{1.1, 1.1}}}, 1, random);
    EXPECT_THAT([&] { place_without_overlap(large, Vec3::Ones(), 0, random); },
                ThrowsMessage<InvalidInput>(HasSubstr("does not fit")));
}

TEST(Raster, OfASphereHasItsVolumeAndCentre) {
    const std::vector<Grain> grains{{{{Vec3(0.52, 0.43, 0.61), 0.3}}}, {{{Vec3(0.123, 0.101, 0.117), 0.05}}}};
    const Raster raster = rasterise(grains, {100, 90, 110}, 0.01, 2, 1);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_NEAR(static_cast<double>(raster.voxels[i]) * 1e-6 / grains[i].spheres[0].volume(), 1,
                    i == 0 ? 1e-3 : 2e-2);
    EXPECT_EQ(raster.volume.histogram().at(2), raster.voxels[0] + raster.voxels[1]);
    const LabelVolume::Sampler sampler(raster.volume);
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(-0.6, 0, 0.8)}) {
        EXPECT_EQ(sampler.nearest(grains[0].spheres[0].centre + 0.29 * along), 2);
        EXPECT_EQ(sampler.nearest(grains[0].spheres[0].centre + 0.31 * along), 1);
    }
}

TEST(FoamStruts, OfKelvinsCellsHaveTheirLengthPerVolume) {
    Random random(1);
    // A cell has 36 edges of a sqrt(2)/4, each shared by 3 cells, and a volume of a^3/2.
    const double a = 0.5;
    const auto struts = foam_struts(Vec3::Constant(2), a, 0, random);
    double length = 0;
    for (const Strut& strut : struts) {
        EXPECT_NEAR((strut.to - strut.from).norm(), a * std::sqrt(2.0) / 4, 1e-9);
        // Only what lies in the middle: the cells outside the box are not complete.
        const Vec3 middle = (strut.from + strut.to) / 2;
        if ((middle.array() >= 0.5).all() && (middle.array() < 1.5).all()) length += (strut.to - strut.from).norm();
    }
    EXPECT_NEAR(length, 36.0 / 3 * a * std::sqrt(2.0) / 4 / (a * a * a / 2), 1e-9);
}

TEST(FoamStruts, OfIrregularCellsMeetByFour) {
    Random random(5);
    const auto struts = foam_struts(Vec3::Constant(1), 0.25, 1, random);
    int checked = 0, meet_by_four = 0;
    for (const Strut& strut : struts) {
        if (strut.from.minCoeff() < 0.2 || strut.from.maxCoeff() > 0.8) continue;
        const auto same = [&](const Vec3& end) { return (end - strut.from).norm() < 1e-7; };
        ++checked;
        meet_by_four += 4 == std::count_if(struts.begin(), struts.end(),
                                           [&](const Strut& other) { return same(other.from) || same(other.to); });
    }
    EXPECT_GT(checked, 50);
    // Struts too short to draw are left out; they are few.
    EXPECT_GT(meet_by_four, 0.98 * checked);
}

TEST(Foam, HasTheRelativeDensityAndOnePiece) {
    for (const double irregularity : {0.0, 0.7})
        for (const double density : {0.066, 0.18}) {
            Random random(2);
            const auto struts = foam_struts(Vec3::Constant(80), 80.0 / 2, irregularity, random);
            const Foam foam = draw_foam(struts, {80, 80, 80}, 1, density, 2);
            EXPECT_NEAR(static_cast<double>(foam.volume.histogram().at(1)) / 512000, density, 0.002);
            EXPECT_EQ(connected_components(foam.volume, {1}).voxels.size(), 1U);
            EXPECT_EQ(foam.volume.histogram().at(1), foam.solid_voxels);
        }
}

TEST(Foam, IsTheSameOnAnyNumberOfThreads) {
    Random random(2);
    const auto struts = foam_struts(Vec3::Constant(60), 30.0, 0.5, random);
    const Foam one = draw_foam(struts, {60, 60, 60}, 1, 0.1, 1), three = draw_foam(struts, {60, 60, 60}, 1, 0.1, 3);
    std::vector<std::int32_t> a, b;
    one.volume.slices(0, 60, a);
    three.volume.slices(0, 60, b);
    EXPECT_EQ(a, b);
}

TEST(Foam, RejectsStrutsThinnerThanVoxels) {
    Random random(2);
    const auto struts = foam_struts(Vec3::Constant(40), 10.0, 0.5, random);
    EXPECT_THAT(
        [&] {
            draw_foam(struts, {40, 40, 40}, 1, 0.01, 2);
        },
        ThrowsMessage<InvalidInput>(HasSubstr("do not hold together")));
}

}  // namespace
}  // namespace tomodem::phantom
