#pragma once
#include "solver_plugin/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/bilin_properties.hpp"
#include "solver_plugin/vector_pairs.hpp"

namespace tomodem::plugin {

/// `pair_style gran model bilin tangential off`: BILIN between particles, from LIGGGHTS' neighbour list to the forces.
///
/// It replaces LIGGGHTS' generic pair loop: no rotation, no torque, no contact history. The radius of a particle is its
/// crown radius. Needs `newton off` and `communicate single vel yes` (ghosts carry the velocity that the law reads).
///
/// Steps without energy or virial run on VectorPairs where the machine has AVX2 and the radii of each type are equal;
/// the scalar loop is the reference, and serves everything else. TOMODEM_KERNEL=scalar in the environment forces it.
class BilinPair : private LAMMPS_NS::Pointers, public LIGGGHTS::PairStyles::IGranularPairStyle {
 public:
    explicit BilinPair(LAMMPS_NS::LAMMPS* lmp) : Pointers(lmp) {}

    void settings(int, char**, LIGGGHTS::IContactHistorySetup*) override {}
    void init_granular() override;
    void write_restart_settings(FILE* file) override;
    void read_restart_settings(FILE* file, int64_t hashcode) override;
    void compute_force(LAMMPS_NS::PairGran* pair, int energy_flag, int virial_flag, int add_flag) override;
    int get_history_offset(const std::string) override { return -1; }
    double stressStrainExponent() override { return 1.0; }
    int64_t hashcode() override;
    bool contact_match(const std::string type, const std::string model) override;

 private:
    void compute_scalar(LAMMPS_NS::PairGran& pair);
    void compute_vector(LAMMPS_NS::PairGran& pair);
    bool prepare_vector();

    BilinProperties properties_;
    VectorPairs vector_pairs_;
    bool vector_ready_ = false;
};

/// Elastic energy of the overlapping seeds of this process' share of the pairs.
double seed_energy(LAMMPS_NS::LAMMPS* lmp);

}  // namespace tomodem::plugin
