#include "solver_plugin/norton/rigid_motion.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace tomodem::plugin {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// What walls oppose less, over the motion that they oppose most, is free.
constexpr double free_share = 1e-6;

}  // namespace

Eigen::Matrix<double, 3, 6> RigidMotion::at(int i) const {
    const Eigen::Vector3d arm = (Eigen::Map<const Eigen::Vector3d>(position_ + 3 * i) - centre_) / size_;
    Eigen::Matrix<double, 3, 6> motions;
    motions.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) motions.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(arm);
    return motions;
}

void RigidMotion::find(const double* position, int count, const std::vector<NearWall>& walls,
                       const FlowSurroundings& surroundings) {
    position_ = position;
    count_ = count;
    double sums[5] = {0, 0, 0, 0, static_cast<double>(count)};
    for (int i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) sums[c] += position[3 * i + c];
    surroundings.add_up(sums, 5);
    centre_ = Eigen::Vector3d(sums) / sums[4];
    double squares = 0;
    for (int i = 0; i < count; ++i)
        squares += (Eigen::Map<const Eigen::Vector3d>(position + 3 * i) - centre_).squaredNorm();
    surroundings.add_up(&squares, 1);
    size_ = squares > 0 ? std::sqrt(squares / sums[4]) : 1;

    Matrix6 matrices[2] = {Matrix6::Zero(), Matrix6::Zero()};  // products of the motions; what walls oppose
    for (int i = 0; i < count; ++i) {
        const Eigen::Matrix<double, 3, 6> motions = at(i);
        matrices[0] += motions.transpose() * motions;
    }
    for (const NearWall& wall : walls) {
        const Vector6 along = at(wall.particle).transpose() * Eigen::Map<const Eigen::Vector3d>(wall.normal);
        matrices[1] += along * along.transpose();
    }
    surroundings.add_up(matrices[0].data(), 36);
    surroundings.add_up(matrices[1].data(), 36);
    // Between periodic sides a sample cannot turn.
    const int motions = surroundings.can_turn() ? 6 : 3;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> opposed(matrices[1].topLeftCorner(motions, motions));
    const double most = opposed.eigenvalues()[motions - 1];
    int found = 0;
    while (found < motions && opposed.eigenvalues()[found] <= free_share * most) ++found;
    free_ = Modes::Zero(6, found);
    free_.topRows(motions) = opposed.eigenvectors().leftCols(found);
    // Particles in one line cannot be seen to turn about it.
    const Eigen::MatrixXd mass = free_.transpose() * matrices[0] * free_;
    over_mass_ = mass.completeOrthogonalDecomposition().pseudoInverse();
}

void RigidMotion::remove(std::vector<Four>& motion, const FlowSurroundings& surroundings) const {
    if (free_.cols() == 0) return;
    Vector6 products = Vector6::Zero();
    for (int i = 0; i < count_; ++i)
        products += at(i).transpose() * Eigen::Vector3d(motion[i][0], motion[i][1], motion[i][2]);
    surroundings.add_up(products.data(), 6);
    const Vector6 shares = free_ * (over_mass_ * (free_.transpose() * products));
    for (int i = 0; i < count_; ++i) {
        const Eigen::Vector3d rigid = at(i) * shares;
        for (int c = 0; c < 3; ++c) motion[i][c] -= static_cast<float>(rigid[c]);
    }
}

}  // namespace tomodem::plugin
