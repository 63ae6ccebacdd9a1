#include "tools/metrics/shapes/ellipsoid.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>

#include "tests/unit/metrics/synthetic_run.hpp"

namespace tomodem::shapes {
namespace {

double shape_factor_of(const std::vector<Vec3>& centres) {
    std::vector<std::size_t> all(centres.size());
    std::iota(all.begin(), all.end(), 0);
    return shape_factor(second_moments(centres, all));
}

TEST(ShapeFactor, TakesTheHeightAlongTheLoadAxis) {
    const Mat3 moments = Vec3(9, 1, 4).asDiagonal();
    EXPECT_DOUBLE_EQ(shape_factor(moments, 2), 2 / 2.0);
    EXPECT_DOUBLE_EQ(shape_factor(moments, 0), 3 / 1.5);
    EXPECT_DOUBLE_EQ(shape_factor(moments, 1), 1 / 2.5);
    EXPECT_DOUBLE_EQ(shape_factor(moments), shape_factor(moments, 2));
}

TEST(ShapeFactor, OfAnEllipsoidIsItsHeightOverItsMeanWidth) {
    const std::vector<Vec3> centres = synthetic::ellipsoid({4.0, 6.0, 3.0}, 0.2, {7, 8, 9});
    ASSERT_GT(centres.size(), 30000u);
    EXPECT_NEAR(shape_factor_of(centres), 3.0 / 5.0, 1e-3);
}

TEST(ShapeFactor, OfASphereIsOne) {
    EXPECT_NEAR(shape_factor_of(synthetic::ellipsoid({5, 5, 5}, 0.2)), 1.0, 1e-3);
}

TEST(ShapeFactor, FollowsAnIsochoricCompressionExactly) {
    const std::vector<Vec3> sphere = synthetic::ellipsoid({5, 5, 5}, 0.5);
    EXPECT_NEAR(shape_factor_of(synthetic::deformed(sphere, -0.3)) / shape_factor_of(sphere), std::exp(-0.45), 1e-12);
}

TEST(SecondMoments, OfAnEllipsoidAreAFifthOfTheSquaredAxes) {
    const std::vector<Vec3> centres = synthetic::ellipsoid({4.0, 6.0, 3.0}, 0.2);
    std::vector<std::size_t> all(centres.size());
    std::iota(all.begin(), all.end(), 0);
    const Vec3 moments = second_moments(centres, all).diagonal();
    EXPECT_NEAR(moments.x(), 16.0 / 5.0, 0.02);
    EXPECT_NEAR(moments.y(), 36.0 / 5.0, 0.02);
    EXPECT_NEAR(moments.z(), 9.0 / 5.0, 0.02);
}

/// Second moments of an ellipsoid, turned.
Mat3 moments_of(const Vec3& semi_axes, const Mat3& turn = Mat3::Identity()) {
    return turn * (semi_axes.cwiseAbs2() / 5.0).asDiagonal() * turn.transpose();
}

Mat3 turned(double degrees, const Vec3& around) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, around.normalized()).toRotationMatrix();
}

TEST(EllipsoidOf, ATurnedEllipsoidHasItsAxesAndDirections) {
    const Mat3 turn = turned(33, {1, 2, 3});
    const Ellipsoid ellipsoid = ellipsoid_of(moments_of({2, 5, 3}, turn));
    EXPECT_NEAR(ellipsoid.semi_axis[0], 5.0, 1e-12);
    EXPECT_NEAR(ellipsoid.semi_axis[1], 3.0, 1e-12);
    EXPECT_NEAR(ellipsoid.semi_axis[2], 2.0, 1e-12);
    EXPECT_NEAR(axis_angle(ellipsoid.direction[0], turn.col(1)), 0.0, 1e-6);
    EXPECT_NEAR(axis_angle(ellipsoid.direction[1], turn.col(2)), 0.0, 1e-6);
    EXPECT_NEAR(axis_angle(ellipsoid.direction[2], turn.col(0)), 0.0, 1e-6);
    for (const Vec3& direction : ellipsoid.direction) {
        EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
        EXPECT_GT(direction.maxCoeff(), -direction.minCoeff());
    }
}

TEST(EllipsoidOf, PointsInAPlaneHaveNoThirdAxis) {
    EXPECT_DOUBLE_EQ(ellipsoid_of(moments_of({2, 0, 3})).semi_axis[2], 0.0);
}

TEST(OwnShapeFactor, OfAnEllipsoidThatLiesAskewIsNotThatOfItsShadows) {
    const Mat3 moments = moments_of({1, 1, 2}, turned(30, {1, 0, 0}));
    EXPECT_NEAR(own_shape_factor(ellipsoid_of(moments)), 2.0, 1e-12);
    const double height = std::sqrt(0.75 * 4 + 0.25), width = std::sqrt(0.25 * 4 + 0.75);
    EXPECT_NEAR(shape_factor(moments), height / (0.5 * (1 + width)), 1e-12);
    EXPECT_NEAR(own_shape_factor(ellipsoid_of(moments), 0), 1 / 1.5, 1e-12);
}

TEST(Follow, AxesOfATurningBodyNeverFlip) {
    Ellipsoid before = ellipsoid_of(moments_of({3, 2, 1}));
    const Ellipsoid first = before;
    for (int degrees = 0; degrees <= 360; degrees += 6) {
        Ellipsoid now = ellipsoid_of(moments_of({3, 2, 1}, turned(degrees, {1, 1, 0.3})));
        follow(now, before);
        for (int k = 0; k < 3; ++k) {
            EXPECT_GT(now.direction[k].dot(before.direction[k]), std::cos(0.11)) << degrees;
            EXPECT_EQ(now.follows[k], k);
        }
        before = now;
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR((before.direction[k] - first.direction[k]).norm(), 0.0, 1e-9);
}

TEST(Follow, TellsWhichAxisIsWhichWhenLengthsPassEachOther) {
    // The height falls from the longest to the shortest.
    Ellipsoid before = ellipsoid_of(moments_of({1.0, 1.1, 2.0}));
    for (double height = 2.0; height > 0.4; height -= 0.1) {
        Ellipsoid now = ellipsoid_of(moments_of({1.0 / std::sqrt(height / 2), 1.1 / std::sqrt(height / 2), height}));
        follow(now, before);
        before = now;
    }
    EXPECT_THAT(before.follows, testing::ElementsAre(1, 2, 0));  // y, x, z
    EXPECT_NEAR(before.direction[2].z(), 1.0, 1e-12);
}

TEST(AxisAngle, HasNoSign) {
    EXPECT_NEAR(axis_angle({1, 0, 0}, {-1, 0, 0}), 0.0, 1e-12);
    EXPECT_NEAR(axis_angle({1, 0, 0}, {0, 2, 0}), 90.0, 1e-12);
    EXPECT_NEAR(axis_angle({1, 0, 0}, {-1, 1, 0}), 45.0, 1e-12);
}

TEST(ShapeColumns, AreAsManyAsTheirCells) {
    std::vector<Table::Cell> row;
    append_cells(shape_of({1, 2, 3}, 4.0, moments_of({1, 2, 3}), 2), row);
    ASSERT_EQ(row.size(), shape_columns().size());
    EXPECT_EQ(shape_columns()[3], "volume [mm^3]");
    EXPECT_EQ(std::get<double>(row[3]), 4.0);
}

}  // namespace
}  // namespace tomodem::shapes
