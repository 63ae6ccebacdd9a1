#pragma once
#include <array>
#include <memory>
#include <vector>

#include "core/scene/load_path.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"
#include "solver_plugin/pairs/triangle_contacts.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/surface`: a rigid triangulated surface that moves as prescribed, under the wall law of each
/// particle; one contact for every local minimum of the distance. Both sides count.
class FixSurface : public LAMMPS_NS::Fix {
 public:
    struct Motion {
        Vec3 velocity = Vec3::Zero();
        double start = 0.0, stop = 0.0;  ///< s of the load
    };
    /// Sum of the forces on the sample over the steps since the last reset.
    struct Forces {
        Vec3 sum = Vec3::Zero();
        long steps = 0;
    };

    FixSurface(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {}

    /// @param mesh  where it is until it starts
    void place(const TriangleMesh& mesh, const Motion& motion);
    /// The time of the load that the motion goes by from now on; before the first call the surface is at rest.
    void follow(const LoadClock& clock) { clock_ = clock; }
    /// This process' share; the sum over processes is the force.
    Forces take_forces();
    /// Particles of this process nearer than `distance` at the present step.
    std::int64_t particles_within(double distance) const;

    /// In that step, sums force times lever (from the centre to where the force acts) of each particle, xx yy zz xy xz
    /// yz.
    void tally_at(LAMMPS_NS::bigint step) { tally_step_ = step; }
    const std::array<double, 6>& tallied(int i) const { return tally_[static_cast<std::size_t>(i)]; }
    /// zz of that sum in the last step, this process' share [uN mm].
    double virial() const { return virial_; }

    /// Contacts with the particles of this process, for a kernel that finds the velocities.
    /// @param start, interval  as FlowSurroundings::walls()
    void add_walls(double start, double interval, int number, std::vector<NearWall>& walls) const;

    int setmask() override;
    void setup(int flag) override { post_force(flag); }
    void post_force(int) override;

 private:
    /// @param time  of the load [s]
    Vec3 displacement(double time) const;
    Vec3 place_of(int i, const Vec3& displacement) const;
    void choose_candidates(const Vec3& displacement);

    struct Candidate {
        int particle;
        std::vector<int> triangles;
    };
    std::unique_ptr<TriangleTree> tree_;
    Motion motion_;
    LoadClock clock_;
    Forces forces_;
    std::vector<Candidate> candidates_;
    std::vector<SurfaceContact> contacts_;
    LAMMPS_NS::bigint tally_step_ = -1;
    std::vector<std::array<double, 6>> tally_;
    double virial_ = 0;
    Vec3 chosen_at_ = Vec3::Zero();
};

}  // namespace tomodem::plugin
