#pragma once
#include <vector>

#include "solver_plugin/quasi_static/flow_forces.hpp"
#include "solver_plugin/quasi_static/flow_kernel.hpp"

namespace tomodem::plugin {

/// Law NORTON in explicit steps: the forces with the velocities that the particles have (docs/norton.md).
class NortonSteps final : public FlowKernel {
 public:
    NortonSteps();

    /// May be called between any two steps.
    /// @param list_skin  of its pairs, over the crown distance
    void set_law(const law::Norton& law, double list_skin);

    void add_forces(const ParticleView& particles, const NeighbourView& list, const PairStep& step, double* forces,
                    ContactMemory* memory, const UsePair* use) override;
    /// With the velocities of the last step, whatever the particles have now.
    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory* memory,
                     const UsePair& use) const override;
    double wall_force(const WallContact& contact) const override;
    double face() const override { return forces_.law().seed_diameter / 2; }
    double seed_energy(const ParticleView& particles, const NeighbourView& list) const override;

 private:
    FlowForces forces_;
    std::vector<Four> velocity_;  ///< of the last step, ghosts included
};

}  // namespace tomodem::plugin
