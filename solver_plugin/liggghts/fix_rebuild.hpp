#pragma once
#include <vector>

#include "solver_plugin/liggghts/liggghts.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/rebuild`: has LIGGGHTS exchange and sort its particles when one has moved by half the skin, as
/// LIGGGHTS' own test does, which must be off (`neigh_modify every N check no`, N beyond the end of the run). It needs
/// 12 bytes a particle instead of 32. Only for a box whose sides are not periodic: it does not look at how they move.
class FixRebuild : public LAMMPS_NS::Fix {
 public:
    FixRebuild(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {
        force_reneighbor = 1;
        next_reneighbor = -1;  // LIGGGHTS compares it before anything has set it
    }

    int setmask() override;
    void initial_integrate(int) override;
    void post_integrate() override;

 private:
    std::vector<float> built_at_;  // 3 per particle of this process
};

}  // namespace tomodem::plugin
