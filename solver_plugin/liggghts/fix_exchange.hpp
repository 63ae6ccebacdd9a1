#pragma once
#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/law_pair.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/exchange`: carries what a kernel has found of its particles to their ghosts. The pair style adds
/// it by itself where its kernel needs it.
class FixExchange : public LAMMPS_NS::Fix {
 public:
    FixExchange(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {
        comm_forward = kernel().exchanged();
    }

    int setmask() override { return 0; }
    int pack_comm(int count, int* list, double* buffer, int, int*) override {
        const PairKernel& from = kernel();
        const int size = from.carried();
        for (int k = 0; k < count; ++k) from.pack(list[k], buffer + size * k);
        return size;
    }
    void unpack_comm(int count, int first, double* buffer) override {
        PairKernel& to = kernel();
        const int size = to.carried();
        for (int k = 0; k < count; ++k) to.unpack(first + k, buffer + size * k);
    }

 private:
    PairKernel& kernel() const { return LawPair::of(*lmp)->kernel(); }
};

}  // namespace tomodem::plugin
