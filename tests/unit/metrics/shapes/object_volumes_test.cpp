#include "tools/metrics/shapes/object_volumes.hpp"

#include <gmock/gmock.h>

#include <random>

#include "tests/unit/metrics/synthetic_run.hpp"

namespace tomodem::shapes {
namespace {

/// A cube of 20 particles an edge, one diameter apart but for a jitter; objects are boxes of them.
struct Sample {
    Packing packing = synthetic::sample(synthetic::cube(19, 1.0));
    AlphaSurface surface;
    Sample() {
        std::mt19937 random(2);
        for (Vec3& p : packing.position)
            for (int c = 0; c < 3; ++c) p[c] += 0.2 * (double(random()) / 4294967296.0 - 0.5);
        surface = surface_of_all(packing.position, packing.seed_radius);
    }
    Object box(std::int32_t number, const Eigen::Vector3i& from, const Eigen::Vector3i& to, std::int32_t species) {
        Object object{number, species, {}};
        for (int k = from.z(); k < to.z(); ++k)
            for (int j = from.y(); j < to.y(); ++j)
                for (int i = from.x(); i < to.x(); ++i) object.members.push_back(std::size_t((k * 20 + j) * 20 + i));
        return object;
    }
};

TEST(ObjectVolumes, OfParticlesInsideAreTheSumOfTheirShares) {
    Sample sample;
    const std::vector<Object> objects{sample.box(1, {5, 5, 5}, {15, 15, 15}, 1),
                                      sample.box(2, {4, 8, 8}, {7, 10, 10}, 1)};
    const std::vector<ObjectVolume> volumes = object_volumes(sample.surface, objects, 0.0);
    EXPECT_EQ(volumes[0].share, ShareOf::all);
    EXPECT_NEAR(volumes[0].volume, 1000.0, 10.0);
    EXPECT_EQ(volumes[1].share, ShareOf::all);  // however few
    EXPECT_NEAR(volumes[1].volume, 12.0, 1.0);
}

TEST(ObjectVolumes, AtAFaceAreToldByTheParticlesFurtherIn) {
    Sample sample;
    const std::vector<Object> objects{sample.box(1, {0, 0, 0}, {12, 12, 12}, 1)};
    const std::vector<ObjectVolume> volumes = object_volumes(sample.surface, objects, 0.0);
    EXPECT_EQ(volumes[0].share, ShareOf::inside);
    EXPECT_NEAR(volumes[0].volume, 1728.0, 26.0);
}

TEST(ObjectVolumes, OfFewParticlesAtAFaceTakeTheMeanOfTheSpecies) {
    Sample sample;
    const std::vector<Object> objects{sample.box(1, {0, 0, 0}, {3, 3, 3}, 1), sample.box(2, {0, 0, 9}, {12, 12, 19}, 1),
                                      sample.box(3, {17, 17, 17}, {20, 20, 20}, 2)};
    const std::vector<ObjectVolume> volumes = object_volumes(sample.surface, objects, 1.5);
    EXPECT_EQ(volumes[0].share, ShareOf::species);
    EXPECT_NEAR(volumes[0].volume, 27.0, 0.4);
    EXPECT_EQ(volumes[2].share, ShareOf::box);  // none of species 2 is inside
    EXPECT_DOUBLE_EQ(volumes[2].volume, 27.0 * 1.5);
}

TEST(ObjectVolumes, FollowTheirOwnParticlesWhereObjectsAreOfAnotherDensity) {
    Sample sample;
    for (Vec3& p : sample.packing.position)
        if (p.x() > 9.5) p.x() = 9.5 + 0.9 * (p.x() - 9.5);
    sample.surface = surface_of_all(sample.packing.position, sample.packing.seed_radius);
    const std::vector<Object> objects{sample.box(1, {3, 5, 5}, {9, 15, 15}, 1),
                                      sample.box(2, {11, 5, 5}, {17, 15, 15}, 1)};
    const std::vector<ObjectVolume> volumes = object_volumes(sample.surface, objects, 0.0);
    EXPECT_NEAR(volumes[0].volume, 600.0, 9.0);
    EXPECT_NEAR(volumes[1].volume, 540.0, 9.0);
}

TEST(ObjectVolumes, WithoutASurfaceAreThoseOfTheBox) {
    Sample sample;
    const std::vector<ObjectVolume> volumes =
        object_volumes({}, std::vector<Object>{sample.box(1, {0, 0, 0}, {3, 3, 3}, 1)}, 2.0);
    EXPECT_EQ(volumes[0].share, ShareOf::box);
    EXPECT_DOUBLE_EQ(volumes[0].volume, 54.0);
}

}  // namespace
}  // namespace tomodem::shapes
