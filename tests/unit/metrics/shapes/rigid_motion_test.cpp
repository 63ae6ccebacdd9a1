#include "tools/metrics/shapes/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>

#include "tests/unit/metrics/synthetic_run.hpp"
#include "tools/metrics/shapes/ellipsoid.hpp"

namespace tomodem::shapes {
namespace {

constexpr double degrees = std::numbers::pi / 180.0;

std::vector<std::size_t> all_of(const std::vector<Vec3>& points) {
    std::vector<std::size_t> members(points.size());
    std::iota(members.begin(), members.end(), 0);
    return members;
}

/// Turned about their mean, and moved.
std::vector<Vec3> moved(const std::vector<Vec3>& points, const Vec3& rotation, const Vec3& displacement) {
    const Vec3 middle = mean_of(points, all_of(points));
    const double angle = rotation.norm() * degrees;
    const Eigen::AngleAxisd turn(angle, angle > 0.0 ? rotation.normalized() : Vec3::UnitZ());
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.push_back(turn * (p - middle) + middle + displacement);
    return result;
}

void expect_found(const std::vector<Vec3>& points, const Vec3& rotation, const Vec3& displacement) {
    SCOPED_TRACE(testing::Message() << points.size() << " points, " << rotation.transpose() << " degrees");
    const RigidMotion motion = rigid_motion(points, moved(points, rotation, displacement), all_of(points));
    ASSERT_TRUE(motion.rotation.has_value());
    EXPECT_LT((*motion.rotation - rotation).norm(), 1e-6);
    EXPECT_LT((motion.displacement - displacement).norm(), 1e-6);
    EXPECT_LT(*motion.residual, 1e-6);
}

TEST(RigidMotion, FindsThePrescribedOneWhateverTheObjectAndTheAngle) {
    const std::vector<std::vector<Vec3>> objects{
        synthetic::ellipsoid({4, 3, 2}, 1.0, {100, -50, 20}),  // far from the origin
        synthetic::cube(4, 1.0),                               // symmetric: the particles tell its orientations apart
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},                     // three, in one plane
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    };
    for (const auto& points : objects)
        for (const double angle : {0.0, 1e-5, 0.01, 1.0, 30.0, 90.0, 120.0, 170.0, 179.9})
            for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(-1, 2, 3), Vec3(1, -1, 0)})
                expect_found(points, angle * axis.normalized(), {0.3, -0.2, 5.0});
}

TEST(RigidMotion, HasNoRotationWhereThePointsLieOnALine) {
    const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 2}, {2, 2, 4}, {5, 5, 10}};
    for (const auto& points : {std::vector<Vec3>{{1, 2, 3}}, {{1, 2, 3}, {2, 2, 2}}, line}) {
        const RigidMotion motion = rigid_motion(points, moved(points, {0, 0, 40}, {1, 2, 3}), all_of(points));
        EXPECT_LT((motion.displacement - Vec3(1, 2, 3)).norm(), 1e-12);
        EXPECT_FALSE(motion.rotation.has_value());
        EXPECT_FALSE(motion.residual.has_value());
    }
}

TEST(RigidMotion, LeavesADeformationAsItsResidual) {
    const std::vector<Vec3> points = synthetic::cube(6, 1.0);
    const RigidMotion motion = rigid_motion(points, synthetic::deformed(points, -0.2), all_of(points));
    ASSERT_TRUE(motion.rotation.has_value());
    EXPECT_LT(motion.rotation->norm(), 1e-6);
    // The stretch less one, times the root mean square of a coordinate about its mean (2).
    const double along = 1.0 - std::exp(-0.2), across = std::exp(0.1) - 1.0;
    EXPECT_NEAR(*motion.residual, 2.0 * std::sqrt(along * along + 2.0 * across * across), 1e-9);
}

TEST(RigidMotion, IsARotationWhereThePointsAreMirrored) {
    const std::vector<Vec3> points = synthetic::ellipsoid({4, 3, 2}, 1.0);
    std::vector<Vec3> mirrored = points;
    for (Vec3& p : mirrored) p.z() = -p.z();
    const RigidMotion motion = rigid_motion(points, mirrored, all_of(points));
    EXPECT_GT(*motion.residual, 0.5);
}

}  // namespace
}  // namespace tomodem::shapes
