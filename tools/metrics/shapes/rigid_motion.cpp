#include "tools/metrics/shapes/rigid_motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "tools/metrics/shapes/ellipsoid.hpp"

namespace tomodem::shapes {
namespace {

/// Below this share of the largest singular value the second one is rounding: the points lie on one line.
constexpr double on_a_line = 1e-10;

}  // namespace

RigidMotion rigid_motion(std::span<const Vec3> before, std::span<const Vec3> after,
                         std::span<const std::size_t> members) {
    const Vec3 from = mean_of(before, members), to = mean_of(after, members);
    RigidMotion motion{.displacement = to - from};
    Mat3 covariance = Mat3::Zero();
    for (const std::size_t i : members) covariance += (before[i] - from) * (after[i] - to).transpose();
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (!(svd.singularValues()[1] > on_a_line * svd.singularValues()[0])) return motion;

    Vec3 mirrored = Vec3::Ones();
    mirrored[2] = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
    const Mat3 rotation = svd.matrixV() * mirrored.asDiagonal() * svd.matrixU().transpose();
    const Eigen::AngleAxisd turn(rotation);
    motion.rotation = turn.angle() * 180.0 / std::numbers::pi * turn.axis();
    double squares = 0.0;
    for (const std::size_t i : members) squares += (after[i] - to - rotation * (before[i] - from)).squaredNorm();
    motion.residual = std::sqrt(squares / double(members.size()));
    return motion;
}

}  // namespace tomodem::shapes
