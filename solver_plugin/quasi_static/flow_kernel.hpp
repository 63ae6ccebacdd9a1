#pragma once
#include <cstddef>

#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// What both schemes of law NORTON have in common as kernels: they look for their pairs themselves, and carry what
/// FlowForces has found of the particles to their ghosts.
class FlowKernel : public PairKernel {
 public:
    bool finds_pairs() const override { return true; }
    int exchanged() const override { return most_carried; }
    int carried() const override { return static_cast<int>((size_ + sizeof(double) - 1) / sizeof(double)); }
    void pack(int i, double* numbers) const override;
    void unpack(int i, const double* numbers) override;

 protected:
    /// FlowForces::Carry
    void carry(void* first, std::size_t stride, std::size_t size);

 private:
    /// Numbers of a particle: the state of FlowForces has no more.
    static constexpr int most_carried = 12;

    char* first_ = nullptr;
    std::size_t stride_ = 0, size_ = 0;
};

}  // namespace tomodem::plugin
