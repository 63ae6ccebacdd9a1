#include "tools/render/projection.hpp"

#include <gmock/gmock.h>

#include "tools/render/series.hpp"
#include "tools/render/subject.hpp"

namespace tomodem::render {
namespace {

Picture picture_of(const Vec3& edges) {
    Picture picture;
    picture.view = view_of({.origin = Vec3(1, 2, 3), .edges = edges}, Cut::none);
    return picture;
}

void expect_within(const Picture& picture) {
    const Projection view = projection(picture);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 share(corner & 1, corner >> 1 & 1, corner >> 2);
        const auto pixel = view.pixel(picture.view.low + share.cwiseProduct(picture.view.high - picture.view.low));
        EXPECT_GT(pixel.x(), 0);
        EXPECT_LT(pixel.x(), picture.width);
        EXPECT_GT(pixel.y(), 0.05 * picture.height);
        EXPECT_LT(pixel.y(), 0.95 * picture.height);
    }
}

TEST(Projection, HoldsTheWholeRegion) {
    for (const Vec3& edges : {Vec3(1, 1, 1), Vec3(10, 1, 1), Vec3(1, 10, 0.1), Vec3(0.1, 0.1, 5)})
        expect_within(picture_of(edges));
}

TEST(Projection, OfATurntableHasOneScaleAndHoldsTheRegionFromEverySide) {
    const Picture still = picture_of({4, 1, 2});
    double scale = 0;
    for (int k = 0; k < 12; ++k) {
        Picture picture = still;
        picture.view = turned(still.view, k / 12.0);
        expect_within(picture);
        const double now = projection(picture).mm_per_pixel;
        if (k == 0) scale = now;
        EXPECT_NEAR(now, scale, 1e-12);
    }
}

TEST(Projection, OfASliceIsStraight) {
    Picture picture = picture_of({1, 1, 1});
    for (const int axis : {0, 1, 2}) {
        picture.view = view_of({.origin = Vec3::Zero(), .edges = Vec3::Ones()}, Cut::none, axis);
        const Projection view = projection(picture);
        const auto from = view.pixel(Vec3::Zero()), to = view.pixel(Vec3::Unit(axis));
        EXPECT_NEAR((to - from).norm(), 0, 1e-9);
        // Right is x (or y), up is z (or y): as one draws axes.
        const Vec3 right = axis == 0 ? Vec3::UnitY() : Vec3::UnitX(), up = axis == 2 ? Vec3::UnitY() : Vec3::UnitZ();
        EXPECT_NEAR(view.right.dot(right), 1, 1e-12);
        EXPECT_NEAR(view.up.dot(up), 1, 1e-12);
    }
}

}  // namespace
}  // namespace tomodem::render
