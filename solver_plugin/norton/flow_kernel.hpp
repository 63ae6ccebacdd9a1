#pragma once
#include <cstddef>

#include "solver_plugin/norton/flow_forces.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// What both schemes of law NORTON have in common as kernels: they look for their pairs themselves, carry what
/// FlowForces has found of the particles to their ghosts, and have the same film at the planes.
class FlowKernel : public PairKernel {
 public:
    FlowKernel();

    bool finds_pairs() const override { return true; }
    int exchanged() const override { return most_carried; }
    int carried() const override { return static_cast<int>((size_ + sizeof(double) - 1) / sizeof(double)); }
    void pack(int i, double* numbers) const override;
    void unpack(int i, const double* numbers) override;
    double plane_reach(double /*radius*/) const override {
        return (0.5 + law::NortonConstants::film_range) * law().seed_diameter;
    }
    double face() const override { return law().seed_diameter / 2; }
    double seed_energy(const ParticleView&, const NeighbourView&) const override { return forces_.core_energy(); }

 protected:
    const law::Norton& law() const { return forces_.law(); }
    /// Of the load at a time after the present step, by which the film goes [1/s].
    double load_rate(double start) const;
    /// FlowForces::Carry
    void carry(void* first, std::size_t stride, std::size_t size);

    FlowForces forces_;

 private:
    /// Numbers of a particle: the state of FlowForces has no more.
    static constexpr int most_carried = 12;

    char* first_ = nullptr;
    std::size_t stride_ = 0, size_ = 0;
};

}  // namespace tomodem::plugin
