#pragma once
#include <vector>

#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

struct OneProcess final : FlowSurroundings {
    void add_up(double*, std::size_t) const override {}
    void take_largest(double*, std::size_t) const override {}
    double rate(double) const override { return 0; }
    bool can_turn() const override { return true; }
    std::vector<NearWall> walls(double, double) const override { return {}; }
    std::vector<NearWall> planes(double, double) const override { return {}; }
};

}  // namespace tomodem::plugin
