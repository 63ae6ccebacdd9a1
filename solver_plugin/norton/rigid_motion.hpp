#pragma once
#include <Eigen/Core>
#include <vector>

#include "solver_plugin/norton/four.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// The motions of the whole sample as a rigid body that no wall opposes. No force hinders them either, so a balance of
/// forces says nothing about them: left alone, a sample spins on what a solution is inexact by.
class RigidMotion {
 public:
    /// Finds them for the present places. Collective.
    /// @param position  3 per particle of this process
    /// @param count     of them
    /// @param walls     a motion along the normal of one is opposed
    void find(const double* position, int count, const std::vector<NearWall>& walls,
              const FlowSurroundings& surroundings);

    /// Takes them out of a motion. Collective.
    void remove(std::vector<Four>& motion, const FlowSurroundings& surroundings) const;

    /// How many there are: 6 for a sample that nothing holds, 3 between two planes.
    int count() const { return static_cast<int>(free_.cols()); }

 private:
    using Modes = Eigen::Matrix<double, 6, Eigen::Dynamic>;

    /// Velocity of particle i in each of the six motions: three shifts and three turns about the centre.
    Eigen::Matrix<double, 3, 6> at(int i) const;

    const double* position_ = nullptr;
    int count_ = 0;
    Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
    double size_ = 1;            ///< of the sample [mm]: turns are counted in shifts at that distance
    Modes free_ = Modes(6, 0);   ///< columns
    Eigen::MatrixXd over_mass_;  ///< inverse of the products of the free motions
};

}  // namespace tomodem::plugin
