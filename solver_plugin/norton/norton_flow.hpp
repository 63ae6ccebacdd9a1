#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "solver_plugin/norton/coarse_grid.hpp"
#include "solver_plugin/norton/flow_kernel.hpp"
#include "solver_plugin/norton/rigid_motion.hpp"

namespace tomodem::plugin {

/// Law NORTON without inertia: in each step, the velocities at which all forces balance, found by a conjugate gradient
/// with lagged viscosities (docs/norton.md).
class NortonFlow final : public FlowKernel {
 public:
    /// @param imbalance  norm of the net forces over that of the viscous forces on the particles: below it a step is
    ///                   solved
    void set_law(const law::Norton& law, double imbalance);

    bool finds_velocities() const override { return true; }
    const FlowWork* work() const override { return &work_; }
    double interval() const override { return good_for_; }
    bool keeps_time() const override { return !law().at_rest; }
    void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step, double* forces,
                    ContactMemory* memory, const UsePair* use) override;
    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                     const UsePair& use) const override;
    double wall_force(const WallContact& contact) const override { return forces_.wall_force(contact); }

 private:
    void take(const ParticleView& particles, double share);
    void find_velocities();
    bool balance();
    bool is_balanced() const { return net_norm_ <= imbalance_ * load_norm_; }
    void find_forces();
    void find_motion(double tolerance);
    void prepare();
    double precondition(double& along);

    CoarseGrid grid_;
    RigidMotion rigid_;
    double imbalance_ = 1e-2;
    double interval_ = 0;  ///< that the forces are solved for [s]
    double good_for_ = 0;  ///< that the particles may move with the velocities [s]
    FlowWork work_;

    int local_count_ = 0, count_ = 0;
    std::vector<NearWall> walls_;
    std::vector<Four> jump_;  ///< of the velocity of each ghost against its owner's: periodic sides that move
    std::vector<std::array<double, 3>> found_;  ///< the velocities, as they are found
    std::vector<Four> velocity_;                ///< likewise, ghosts included
    std::vector<Four> net_;                     ///< force on each particle, walls included
    double net_norm_ = 0, load_norm_ = 0;
    std::vector<Four> rest_, step_, direction_, motion_;  ///< of the linear system
    std::vector<FlowBlock> blocks_;                       ///< inverses
    std::vector<double> nodes_;
};

}  // namespace tomodem::plugin
