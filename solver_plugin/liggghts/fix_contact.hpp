#pragma once
#include <cstdint>
#include <limits>

#include "solver_plugin/liggghts/liggghts.hpp"
#include "solver_plugin/pairs/contact_memory.hpp"

namespace tomodem::plugin {

/// `fix contact all tomodem/contact seed_radius R [healing_steps N]`: self-contact of the pair laws on any number of
/// processes. Pairs that were in the crown when it was added are internal. `solve` sets the numbers by itself.
///
/// It keeps the memory with the particles when they change owner, and gives ghosts the outward vectors of their owners
/// before each computation of forces: both processes that see a pair decide alike.
class FixContact : public LAMMPS_NS::Fix {
 public:
    FixContact(LAMMPS_NS::LAMMPS* lmp, int count, char** words);
    ~FixContact() override;

    ContactMemory& memory() { return memory_; }
    /// Interfaces become internal after so many steps.
    void heal_after(std::int64_t steps) { healing_steps_ = steps; }
    /// Room for the present particles, and healing. @return whether interfaces have gone
    bool begin_step();

    int setmask() override;
    void setup_pre_force(int) override { pre_force(0); }
    void pre_force(int) override;

    void grow_arrays(int) override;
    void copy_arrays(int from, int to, int) override;
    void set_arrays(int i) override;
    int pack_exchange(int i, double* buffer) override;
    int unpack_exchange(int i, double* buffer) override;
    int pack_comm(int count, int* list, double* buffer, int, int*) override;
    void unpack_comm(int count, int first, double* buffer) override;

 private:
    ContactMemory memory_;
    static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
    std::int64_t healing_steps_ = never;
};

}  // namespace tomodem::plugin
