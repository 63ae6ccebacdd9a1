#pragma once
#include <vector>

#include "solver_plugin/norton/film_balance.hpp"
#include "solver_plugin/norton/flow_kernel.hpp"

namespace tomodem::plugin {

/// Law NORTON in explicit steps: the forces with the velocities that the particles have; those of the films at the
/// planes with the velocities at the end of the step (docs/norton.md).
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

 private:
    void balance_films(const ParticleView& particles, double time_step);

    FilmBalance films_;
    std::vector<Four> velocity_;  ///< of the last step, ghosts included
};

}  // namespace tomodem::plugin
