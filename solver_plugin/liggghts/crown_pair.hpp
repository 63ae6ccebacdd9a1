#pragma once
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/crown_properties.hpp"
#include "solver_plugin/pairs/norton_pairs.hpp"
#include "solver_plugin/pairs/vector_pairs.hpp"

namespace tomodem::plugin {

class FixContact;
class FixNorton;

/// `pair_style gran model bilin|trilin tangential off`: forces between particles, from LIGGGHTS' neighbour list on.
///
/// It replaces LIGGGHTS' generic pair loop: no rotation, no torque, no contact history. The radius of a particle is its
/// crown radius. Needs `newton off` and `communicate single vel yes` (ghosts carry the velocity that the laws read).
///
/// Steps without energy or virial run on VectorPairs where the machine has AVX2; scalar_pairs is the reference, and
/// serves everything else. TOMODEM_KERNEL=scalar in the environment forces it.
class CrownPair : private LAMMPS_NS::Pointers, public LIGGGHTS::PairStyles::IGranularPairStyle {
 public:
    CrownPair(LAMMPS_NS::LAMMPS* lmp, LAMMPS_NS::PairGran* owner, bool trilin);
    ~CrownPair() override;
    /// The pair style of this LIGGGHTS, null before its `pair_style` command.
    static CrownPair* of(const LAMMPS_NS::LAMMPS& lmp);

    /// Takes the constants from here instead of `fix property/global`. May be called between any two runs.
    void use(const PairLaws& laws);
    /// NORTON instead of BILIN or TRILIN.
    void use(const law::Norton& law);
    /// Attraction only within an object: number of each particle by id - 1, kept by the caller; null: everywhere.
    void tell_objects_apart(const std::int32_t* object) { object_ = object; }
    /// Calls use(i, j) for every pair that may be in the crown: those of two particles of this process once, those
    /// with a ghost with i of this process. Between runs, or in a step after the forces.
    template <class Use>
    void for_each_pair(Use use) const {
        if (const PackedParticles* const particles = packed()) {
            particles->list().for_each_pair(use);
            return;
        }
        const LAMMPS_NS::NeighList& list = *owner_->list;
        for (int row = 0; row < list.inum; ++row)
            for (int entry = 0, i = list.ilist[row]; entry < list.numneigh[i]; ++entry)
                use(i, list.firstneigh[i][entry] & NEIGHMASK);
    }
    /// Null where the scalar loop runs.
    PackedParticles* packed() { return const_cast<PackedParticles*>(std::as_const(*this).packed()); }
    const PackedParticles* packed() const {
        if (norton_) return &norton_pairs_.packed();
        return vectorised_ ? &vector_pairs_.packed() : nullptr;
    }
    /// Null where the law is another.
    NortonPairs* norton() { return norton_ ? &norton_pairs_ : nullptr; }
    /// Elastic energy of the overlapping seeds of this process' share of the pairs.
    double seed_energy();
    /// Sum over this process' share of the pairs of (f_x l_x + f_y l_y) / 2, l the vector between the centres: the
    /// lateral pressure times the volume, as the law saw it in the last step of a run.
    double lateral_virial();

    /// Tells the force of every pair of this process as the law saw it in the last step of a run, and changes nothing.
    /// @param tell  (i, j, force on i [3], vector from j to i [3]); j may be a ghost
    void tell_forces(const std::function<void(int, int, const double*, const double*)>& tell);

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
    void read_properties();
    ParticleView particles() const;

    LAMMPS_NS::PairGran* owner_;
    bool trilin_;
    bool vectorised_ = false;
    bool given_ = false;    ///< the laws came by use()
    bool new_laws_ = true;  ///< VectorPairs does not know them yet
    PairLaws laws_;
    CrownProperties properties_;
    const std::int32_t* object_ = nullptr;
    FixContact* contact_ = nullptr;
    VectorPairs vector_pairs_;
    bool norton_ = false;
    NortonPairs norton_pairs_;
    FixNorton* norton_states_ = nullptr;
};

}  // namespace tomodem::plugin
