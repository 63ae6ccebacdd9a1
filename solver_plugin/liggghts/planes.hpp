#pragma once
#include <vector>

#include "core/scene/load_path.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"

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

    /// In that step, sums force times lever (from the centre to the plane) of each particle: the planes' part of its
    /// stress, zz alone.
    void tally_at(LAMMPS_NS::bigint step) { tally_step_ = step; }
    double tallied(int i) const { return tally_[static_cast<std::size_t>(i)]; }

    int setmask() override;
    void setup(int flag) override { post_force(flag); }
    void post_force(int) override;

 private:
    void take_along(double time);
    void choose_candidates(double low, double high);
    double press(const std::vector<int>& candidates, double plane, double velocity, double inward);

    Motion motion_;
    Forces forces_;
    std::vector<int> near_low_, near_high_;
    LAMMPS_NS::bigint tally_step_ = -1;
    std::vector<double> tally_;
    double chosen_low_ = 0, chosen_high_ = 0;
};

}  // namespace tomodem::plugin
