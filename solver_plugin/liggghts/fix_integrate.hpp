#pragma once
#include "solver_plugin/liggghts/liggghts.hpp"

namespace tomodem::plugin {

class LawPair;

/// `fix ID all tomodem/integrate`: velocity-Verlet of the centres, in place of LIGGGHTS' fix nve.
///
/// Between two steps of a run the two half kicks are made at once: velocities are those of whole steps only after the
/// last step of a run. It also hands the vector loop the new positions while they are in the cache.
class FixIntegrate : public LAMMPS_NS::Fix {
 public:
    FixIntegrate(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) { time_integrate = 1; }

    int setmask() override;
    void initial_integrate(int) override;
    void final_integrate() override;

 private:
    void follow(LawPair& pair);
};

}  // namespace tomodem::plugin
