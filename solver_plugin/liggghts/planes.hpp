#pragma once
#include <array>
#include <vector>

#include "core/scene/load_path.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/planes`: two rigid planes perpendicular to z that press (or pull) the sample at a given true
/// strain rate, v = +-1/2 rate H0 exp(strain), under the wall law of each particle (thesis section 4.4).
///
/// H is the distance of the planes less one seed at each (the height of the layer of centres), strain = ln(H / H0).
class FixPlanes : public LAMMPS_NS::Fix {
 public:
    struct Motion {
        double centre[3] = {0, 0, 0};  ///< of the flow; the planes stand at equal distances from its z
        double initial_height = 0.0;   ///< H0
        double seed_radius = 0.0;
        LoadSegment segment;  ///< begins at first_step
        LAMMPS_NS::bigint first_step = 0;
    };
    /// Sums over the steps since the last reset; forces of the planes on the sample, tension positive.
    struct Forces {
        double top = 0.0, bottom = 0.0;
        long steps = 0;
    };

    FixPlanes(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {}

    void move(const Motion& motion) { motion_ = motion; }
    const Motion& motion() const { return motion_; }
    /// This process' share; the sum over processes is the force.
    Forces take_forces();

    /// In that step, sums force times lever (from the centre to where the plane's force acts) of each particle: the
    /// planes' part of its stress, zz alone.
    void tally_at(LAMMPS_NS::bigint step) { tally_step_ = step; }
    double tallied(int i) const { return tally_[static_cast<std::size_t>(i)]; }
    /// Sum of force times lever in the last step, this process' share [uN mm].
    double virial() const { return virial_; }

    /// Those within reach of the first `count` particles, ghosts follow those of this process; walls are numbered
    /// `first` (below) and `first` + 1.
    /// @param start, interval  as FlowSurroundings::walls()
    void add_walls(double start, double interval, int first, int count, std::vector<NearWall>& walls) const;
    /// Of the strain, at a time after the present step [1/s].
    double rate(double start) const { return motion_.segment.rate_at(time() + start); }
    /// What a uniform flow adds to the velocity of a particle that moves with it, over that velocity.
    /// @param before    the present step the motion begins [s]
    /// @param interval  that it takes [s]
    std::array<double, 3> growth(double before, double interval) const;

    int setmask() override;
    void setup(int flag) override { post_force(flag); }
    void post_force(int) override;

 private:
    double time() const { return update->dt * static_cast<double>(update->ntimestep - motion_.first_step); }
    double half_gap(double time) const;
    void take_along(double time);
    void choose_candidates(double low, double high);
    double press(const std::vector<int>& candidates, double plane, double velocity, double inward);

    Motion motion_;
    Forces forces_;
    std::vector<int> near_low_, near_high_;
    LAMMPS_NS::bigint tally_step_ = -1;
    std::vector<double> tally_;
    double virial_ = 0;
    double chosen_low_ = 0, chosen_high_ = 0;
};

}  // namespace tomodem::plugin
