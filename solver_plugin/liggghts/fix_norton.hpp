#pragma once
#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/crown_pair.hpp"

namespace tomodem::plugin {

/// `fix norton all tomodem/norton`: carries the states of the NORTON law to the ghosts, between its two passes.
class FixNorton : public LAMMPS_NS::Fix {
 public:
    FixNorton(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {
        comm_forward = NortonPairs::exchanged;
    }

    void exchange() { comm->forward_comm_fix(this); }

    int setmask() override { return 0; }
    int pack_comm(int count, int* list, double* buffer, int, int*) override {
        const NortonPairs& pairs = *CrownPair::of(*lmp)->norton();
        for (int k = 0; k < count; ++k) pairs.pack(list[k], buffer + NortonPairs::exchanged * k);
        return NortonPairs::exchanged;
    }
    void unpack_comm(int count, int first, double* buffer) override {
        NortonPairs& pairs = *CrownPair::of(*lmp)->norton();
        for (int k = 0; k < count; ++k) pairs.unpack(first + k, buffer + NortonPairs::exchanged * k);
    }
};

}  // namespace tomodem::plugin
