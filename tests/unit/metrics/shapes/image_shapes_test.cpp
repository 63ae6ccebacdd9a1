#include "tools/metrics/shapes/image_shapes.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <numbers>
#include <random>

#include "core/base/error.hpp"

namespace tomodem::shapes {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// An image whose voxels have the label of their index.
LabelVolume image(const VoxelIndex& size, const Vec3& spacing,
                  const std::function<std::int32_t(std::int32_t, std::int32_t, std::int32_t)>& label,
                  const Vec3& origin = Vec3::Zero()) {
    LabelVolume volume(size, spacing, origin);
    for (std::int32_t k = 0; k < size[2]; ++k) {
        std::vector<std::int32_t> slice;
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i) slice.push_back(label(i, j, k));
        volume.set_slice(k, slice);
    }
    return volume;
}

/// An ellipsoid of semi-axes in voxels.
LabelVolume ellipsoid(const Vec3& semi_axes, const Vec3& spacing = Vec3::Ones()) {
    const Vec3 middle = semi_axes + Vec3(2.3, 2.6, 2.1);
    const VoxelIndex size{int(2 * semi_axes.x()) + 6, int(2 * semi_axes.y()) + 6, int(2 * semi_axes.z()) + 6};
    return image(size, spacing, [&](int i, int j, int k) {
        return (Vec3(i + 0.5, j + 0.5, k + 0.5) - middle).cwiseQuotient(semi_axes).squaredNorm() < 1.0 ? 1 : 0;
    });
}

ImageBody only_object(LabelVolume volume, const BodyChoice& choice = {.min_voxels = 1}) {
    const ImageObjects objects = image_objects(volume, {.components = {1}}, choice);
    EXPECT_EQ(objects.used.size(), 1u);
    return objects.used.front();
}

TEST(VoxelSums, AreThoseOfEveryVoxelAndItsNeighbours) {
    const VoxelIndex size{71, 9, 19};  // more than a block of comparison, more than two slabs
    std::mt19937 random(3);
    std::vector<std::int32_t> labels(71 * 9 * 19);
    for (std::size_t i = 0; i < labels.size(); ++i)
        labels[i] = random() % 3 == 0 ? int(random() % 4) : i > 0 ? labels[i - 1] : 1;
    const auto at = [&](int i, int j, int k) { return labels[(k * size[1] + j) * size[0] + i]; };
    const LabelVolume volume = image(size, Vec3::Ones(), at);
    const std::vector<std::int32_t> wanted{0, 2, 3};
    const std::vector<VoxelSums> sums = voxel_sums(volume, wanted);
    for (std::size_t w = 0; w < wanted.size(); ++w) {
        VoxelSums expected;
        expected.low = size;
        expected.high = {-1, -1, -1};
        for (int k = 0; k < size[2]; ++k)
            for (int j = 0; j < size[1]; ++j)
                for (int i = 0; i < size[0]; ++i)
                    for (std::size_t step = 0; step < pair_steps.size() + 1; ++step) {
                        const bool inside = at(i, j, k) == wanted[w];
                        if (step == pair_steps.size()) {
                            if (!inside) continue;
                            ++expected.voxels;
                            const std::array<std::int64_t, 3> p{i, j, k};
                            for (int c = 0; c < 3; ++c) {
                                expected.sum[c] += p[c];
                                expected.squares[c] += p[c] * p[c];
                                expected.low[c] = std::min(expected.low[c], int(p[c]));
                                expected.high[c] = std::max(expected.high[c], int(p[c]));
                            }
                            expected.squares[3] += p[0] * p[1];
                            expected.squares[4] += p[0] * p[2];
                            expected.squares[5] += p[1] * p[2];
                            continue;
                        }
                        const auto& [di, dj, dk] = pair_steps[step];
                        if (i + di < 0 || j + dj < 0 || i + di >= size[0] || j + dj >= size[1] || k + dk >= size[2])
                            continue;
                        expected.borders[step] += inside != (at(i + di, j + dj, k + dk) == wanted[w]);
                    }
        EXPECT_EQ(sums[w].voxels, expected.voxels);
        EXPECT_EQ(sums[w].sum, expected.sum);
        EXPECT_EQ(sums[w].squares, expected.squares);
        EXPECT_EQ(sums[w].borders, expected.borders);
        EXPECT_EQ(sums[w].low, expected.low);
        EXPECT_EQ(sums[w].high, expected.high);
    }
}

TEST(ImageObjects, ABoxOfVoxelsHasTheMomentsOfTheirCentres) {
    const Vec3 spacing(0.5, 1.0, 2.0), origin(10, 20, 30);
    LabelVolume volume = image(
        {12, 12, 12}, spacing,
        [](int i, int j, int k) { return i >= 2 && i < 10 && j >= 3 && j < 5 && k >= 4 && k < 8 ? 1 : 0; }, origin);
    const ImageObjects objects = image_objects(volume, {.components = {1}}, {});
    ASSERT_EQ(objects.used.size(), 1u);
    const ImageBody& body = objects.used.front();
    EXPECT_EQ(body.voxels, 64);
    EXPECT_FALSE(body.at_boundary);
    EXPECT_NEAR(body.shape.volume, 64.0, 1e-12);
    EXPECT_NEAR((body.shape.centre - Vec3(13, 24, 42)).norm(), 0.0, 1e-12);
    const auto semi_axis = [](double voxels, double size) {
        return size * std::sqrt((voxels * voxels - 1.0) * 5.0 / 12.0);
    };
    EXPECT_NEAR(body.shape.ellipsoid.semi_axis[0], semi_axis(4, 2.0), 1e-12);
    EXPECT_NEAR(body.shape.ellipsoid.semi_axis[1], semi_axis(8, 0.5), 1e-12);
    EXPECT_NEAR(body.shape.ellipsoid.semi_axis[2], semi_axis(2, 1.0), 1e-12);
    EXPECT_NEAR(body.shape.shape_factor, semi_axis(4, 2.0) / (0.5 * (semi_axis(8, 0.5) + semi_axis(2, 1.0))), 1e-12);
    EXPECT_NEAR(body.shape.ellipsoid.direction[0].z(), 1.0, 1e-12);
}

TEST(ImageObjects, WhatLiesInOnePlaneHasNoShape) {
    LabelVolume sheet = image({9, 9, 9}, Vec3::Ones(), [](int i, int j, int k) { return i == j && k > 0; });
    EXPECT_THAT([&] { image_objects(sheet, {.components = {1}, .connectivity = Connectivity::edges}, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("1 have fewer than --min-voxels 27 or lie in one plane")));
}

TEST(ImageObjects, AnEllipsoidHasItsShapeFactorAndAxes) {
    for (const double factor : {0.3, 0.6, 1.0, 2.0, 3.0}) {
        const double width = 24.0 / std::cbrt(factor);
        const Shape shape = only_object(ellipsoid({width, width, factor * width})).shape;
        EXPECT_NEAR(shape.shape_factor / factor, 1.0, 4e-3) << factor;
        EXPECT_NEAR(shape.own_shape_factor / factor, 1.0, 4e-3) << factor;
    }
}

TEST(ImageObjects, VoxelsThatAreNoCubesChangeNothing) {
    const Shape shape = only_object(ellipsoid({40, 20, 10}, {0.5, 1.0, 2.0})).shape;
    for (const double semi_axis : shape.ellipsoid.semi_axis) EXPECT_NEAR(semi_axis, 20.0, 0.08);
    EXPECT_NEAR(shape.shape_factor, 1.0, 4e-3);
}

TEST(CroftonArea, OfABallIsRightToAPercent) {
    for (const double radius : {5.0, 10.0, 20.0}) {
        const ImageBody body = only_object(ellipsoid(Vec3::Constant(radius)));
        EXPECT_NEAR(body.area / (4.0 * std::numbers::pi * radius * radius), 1.0, 0.01) << radius;
        EXPECT_NEAR(body.sphericity, 1.0, 0.01) << radius;
    }
    const ImageBody flat = only_object(ellipsoid({20, 20, 10}, {0.5, 0.5, 1.0}));
    EXPECT_NEAR(flat.area / (400.0 * std::numbers::pi), 1.0, 0.01);
}

TEST(ImageObjects, TellsWhatTouchesAFaceAndLeavesItOutOnDemand) {
    const auto label = [](int i, int j, int k) {
        return j < 4 && k < 4 && (i < 4 || (i > 5 && i < 10)) && k > 0 && j > 0;
    };
    LabelVolume volume = image({12, 6, 6}, Vec3::Ones(), label);
    const ImageObjects objects = image_objects(volume, {.all_components = true}, {});
    ASSERT_EQ(objects.used.size(), 2u);
    EXPECT_TRUE(objects.used[0].at_boundary);
    EXPECT_FALSE(objects.used[1].at_boundary);
    LabelVolume again = image({12, 6, 6}, Vec3::Ones(), label);
    const ImageObjects inside =
        image_objects(again, {.all_components = true}, {.min_voxels = 27, .exclude_boundary = true});
    ASSERT_EQ(inside.used.size(), 1u);
    EXPECT_EQ(inside.used[0].number, 2);
    EXPECT_EQ(inside.at_boundary, 1);
}

TEST(ImageObjects, LabelsThatAreObjectsKeepTheirNumbers) {
    LabelVolume volume = image({12, 4, 4}, Vec3::Ones(), [](int i, int, int) { return i < 4 ? 7 : i < 8 ? 1 : 300; });
    const ImageObjects objects = image_objects(volume, {.components = {1}, .labels = {{5, 400, 2}}}, {});
    ASSERT_EQ(objects.used.size(), 3u);
    EXPECT_EQ(objects.used[0].number, 7);
    EXPECT_EQ(objects.used[0].label, 2);
    EXPECT_EQ(objects.used[1].number, 300);
    EXPECT_EQ(objects.used[2].number, 301);
    EXPECT_EQ(objects.used[2].label, 1);
}

TEST(ImageObjects, RejectsAnImageWithoutWhatIsAskedFor) {
    LabelVolume empty = image({4, 4, 4}, Vec3::Ones(), [](int, int, int) { return 0; });
    EXPECT_THAT([&] { image_objects(empty, {.components = {1}}, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("all of it is void")));
    LabelVolume volume = image({4, 4, 4}, Vec3::Ones(), [](int i, int, int) { return i < 2 ? 1 : 4; });
    EXPECT_THAT([&] { image_objects(volume, {.components = {2}}, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("--objects 2: the image has no such label; it has 1, 4")));
    EXPECT_THAT(
        [&] {
            image_objects(volume, {.labels = {{5, 9, 1}}}, {});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("no label from 5 to 9")));
    EXPECT_THAT([&] { image_objects(volume, {.components = {4}}, {.min_voxels = 33}); },
                ThrowsMessage<InvalidInput>(HasSubstr("1 have fewer than --min-voxels 33")));
}

TEST(VoidParts, AreClosedWhereTheyReachNoFace) {
    // A cavity of 27 voxels, one of 8, and a channel from face to face.
    const auto label = [](int i, int j, int k) {
        if (i >= 2 && i < 5 && j >= 2 && j < 5 && k >= 2 && k < 5) return 0;
        if (i >= 7 && i < 9 && j >= 2 && j < 4 && k >= 2 && k < 4) return 0;
        return i == 7 && j == 7 ? 0 : 1;
    };
    const VoidParts parts = void_parts(image({11, 10, 10}, Vec3::Ones(), label), Connectivity::faces, {});
    ASSERT_EQ(parts.closed.size(), 1u);
    EXPECT_EQ(parts.closed[0].voxels, 27);
    EXPECT_EQ(parts.closed[0].number, 1);
    EXPECT_NEAR((parts.closed[0].shape.centre - Vec3(3.5, 3.5, 3.5)).norm(), 0.0, 1e-12);
    EXPECT_EQ(parts.too_small, 1);
    EXPECT_EQ(parts.closed_voxels, 35);
    EXPECT_EQ(parts.open, 1);
    EXPECT_EQ(parts.open_voxels, 10);
}

TEST(VoidParts, RejectsAnImageOfVoid) {
    EXPECT_THAT(
        [] {
            void_parts(image({4, 4, 4}, Vec3::Ones(), [](int, int, int) { return 0; }), Connectivity::faces, {});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("all of it is void")));
}

TEST(VoidParts, OfASolidAreNone) {
    const VoidParts parts =
        void_parts(image({4, 4, 4}, Vec3::Ones(), [](int, int, int) { return 2; }), Connectivity::faces, {});
    EXPECT_TRUE(parts.closed.empty());
    EXPECT_EQ(parts.open, 0);
}

}  // namespace
}  // namespace tomodem::shapes
