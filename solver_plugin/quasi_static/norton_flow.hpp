#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "solver_plugin/pairs/pair_kernel.hpp"
#include "solver_plugin/quasi_static/coarse_grid.hpp"
#include "solver_plugin/quasi_static/flow_forces.hpp"
#include "solver_plugin/quasi_static/rigid_motion.hpp"

namespace tomodem::plugin {

/// Passes over the pairs that steps have cost; one costs about half a step of the explicit scheme.
struct FlowWork {
    std::int64_t steps = 0;
    std::int64_t solutions = 0;  ///< of a linear system: one or two a step
    std::int64_t geometries = 0, forces = 0, products = 0, blocks = 0;

    std::int64_t evaluations() const { return geometries + forces + products + blocks; }
};

/// Law NORTON without inertia: in each step, the velocities at which all forces balance, found by a conjugate gradient
/// with lagged viscosities (docs/norton.md).
class NortonFlow final : public PairKernel {
 public:
    NortonFlow();

    /// @param imbalance  norm of the net forces over that of the viscous forces on the particles: below it a step is
    ///                   solved
    void set_law(const law::Norton& law, double imbalance);
    const FlowWork& work() const { return work_; }

    bool finds_velocities() const override { return true; }
    double interval() const override { return good_for_; }
    bool keeps_time() const override { return !law().at_rest; }
    void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step, double* forces,
                    ContactMemory* memory, const UsePair* use) override;
    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                     const UsePair& use) const override;
    double wall_force(const WallContact& contact) const override;
    double seed_energy(const ParticleView& particles, const NeighbourView& list) const override;
    int exchanged() const override { return 12; }
    int carried() const override { return (carried_floats_ + 1) / 2; }
    void pack(int i, double* numbers) const override;
    void unpack(int i, const double* numbers) override;

 private:
    const law::Norton& law() const { return forces_.law(); }
    void take(const ParticleView& particles);
    void follow_walls(const ParticleView& particles, bool set_up);
    void remember_slips(const ParticleView& particles);
    bool balance();
    bool is_balanced() const { return net_norm_ <= imbalance_ * load_norm_; }
    void find_forces();
    void find_motion(double tolerance);
    double along_motion() const;
    void prepare();
    double precondition(double& along);
    void add_walls(const Four* motion, bool whole, Four* force) const;
    double film(int type) const;
    double film_at(std::size_t wall) const;
    double stiffness(std::size_t wall) const;
    void carry(float* first, int stride, int floats);

    FlowForces forces_;
    CoarseGrid grid_;
    RigidMotion rigid_;
    double imbalance_ = 1e-2;
    double interval_ = 0;  ///< that the forces are solved for [s]
    double good_for_ = 0;  ///< that the particles may move with the velocities [s]
    FlowWork work_;

    int local_count_ = 0, count_ = 0;
    std::vector<NearWall> walls_;
    double rate_ = 0;                                 ///< of the load, in this step [1/s]
    std::vector<int> wall_type_;                      ///< from 0, of the particle at each wall
    std::unordered_map<std::int64_t, double> slips_;  ///< velocity against a wall, by particle and wall
    std::vector<Four> jump_;  ///< of the velocity of each ghost against its owner's: periodic sides that move
    std::vector<std::array<double, 3>> found_;  ///< the velocities, as they are found
    std::vector<Four> velocity_;                ///< likewise, ghosts included
    std::vector<Four> net_;                     ///< force on each particle, walls included
    double net_norm_ = 0, load_norm_ = 0;
    std::vector<Four> rest_, step_, direction_, motion_;  ///< of the linear system
    std::vector<FlowForces::Block> blocks_;               ///< inverses
    std::vector<double> nodes_;

    float* carried_ = nullptr;
    int stride_ = 0, carried_floats_ = 0;
};

}  // namespace tomodem::plugin
