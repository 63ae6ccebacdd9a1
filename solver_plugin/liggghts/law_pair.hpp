#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/solver_law.hpp"

namespace tomodem::plugin {

class FixContact;
class FixPlanes;

/// `pair_style gran model NAME tangential off`: the forces of a law between particles.
///
/// It replaces LIGGGHTS' generic pair loop: no rotation, no torque, no contact history. The radius of a particle is its
/// crown radius. Needs `newton off` and `communicate single vel yes` (ghosts carry the velocity that the laws read).
class LawPair : private LAMMPS_NS::Pointers, public LIGGGHTS::PairStyles::IGranularPairStyle, private FlowSurroundings {
 public:
    LawPair(LAMMPS_NS::LAMMPS* lmp, LAMMPS_NS::PairGran* owner, const Law& law);
    ~LawPair() override;
    /// The pair style of this LIGGGHTS, null before its `pair_style` command.
    static LawPair* of(const LAMMPS_NS::LAMMPS& lmp);

    /// Takes the constants from here instead of `fix property/global`. May be called between any two runs.
    void use(const PresentModel& present);
    /// Attraction only within an object: number of each particle by id - 1, kept by the caller; null: everywhere.
    void separate_objects(const std::int32_t* object) { object_ = object; }
    const PairKernel& kernel() const { return solver_law_->kernel(); }
    PairKernel& kernel() { return solver_law_->kernel(); }
    /// Of a kernel that finds the velocities: solves the present step anew from `start` [s] after it on.
    void solve_from(double start);
    /// Of such a kernel, in a step before any other force: solves it anew, for images that move otherwise or from other
    /// velocities.
    void solve_again();

    /// Calls use(i, j) for every pair that may be in the crown: those of two particles of this process once, those
    /// with a ghost with i of this process. Between runs, or in a step after the forces.
    template <class Use>
    void for_each_pair(Use use) const {
        kernel().for_each_pair(list(), use);
    }
    /// Elastic energy of the overlapping seeds of this process' share of the pairs.
    double seed_energy() const { return kernel().seed_energy(particles(), list()); }
    /// Sum over this process' share of the pairs of (f_x l_x + f_y l_y) / 2, l the vector between the centres: the
    /// lateral pressure times the volume, as the law saw it in the last step of a run.
    double lateral_virial() const;
    /// Sum over all processes and pairs of f_a l_a, likewise.
    Vec3 virial() const;
    /// Reports the force of every pair of this process as the law saw it in the last step of a run, and changes
    /// nothing.
    void pair_forces(const PairKernel::UsePair& use) const;

    /// Force of a wall on a particle along the wall's normal, repulsion positive.
    /// @param normal  unit vector from the wall to the particle
    /// @param rate    of the distance, relative to the wall
    /// @param plane   WallContact::plane
    double wall_force(int i, double distance, const double* normal, double rate, int plane = -1) const;

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
    template <class Do>
    void refuse_in_script(Do something);
    void read_properties();
    void solve(double start, double* forces);
    void add_up(double* values, std::size_t count) const override;
    void take_largest(double* values, std::size_t count) const override;
    const FixPlanes* fix_planes() const;
    double rate(double start) const override;
    bool can_turn() const override { return domain->xperiodic + domain->yperiodic + domain->zperiodic == 0; }
    std::vector<NearWall> walls(double start, double interval) const override;
    std::vector<NearWall> planes(double start, double interval) const override;
    ParticleView particles() const;
    NeighbourView list() const;

    LAMMPS_NS::PairGran* owner_;
    const Law& law_;
    std::unique_ptr<SolverLaw> solver_law_;
    bool given_ = false;  ///< the constants came by use()
    const std::int32_t* object_ = nullptr;
    FixContact* contact_ = nullptr;
};

}  // namespace tomodem::plugin
