#pragma once
#include <vector>

#include "core/scene/load_path.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/lateral`: periodic sides across z that follow the strain of the planes at constant volume, edge
/// = edge0 exp(-strain / 2) about their middle.
///
/// Particles are not moved with the box. A periodic image moves with the rate of the edge relative to its original:
/// ghosts and particles that cross a side get that jump of velocity (LIGGGHTS' `fix deform ... remap v` does the same,
/// with the box a step behind the particles).
///
/// Where the kernel finds the velocities, that rate is the mean of the step to come, and the sides that carry no stress
/// are found in the step itself: they are steered and the velocities solved for until the stress across is little.
class FixLateralBox : public LAMMPS_NS::Fix {
 public:
    FixLateralBox(LAMMPS_NS::LAMMPS* lmp, int count, char** words);

    /// The present box is that of zero strain.
    void begin();
    /// @param now  the present step: rates of the box are those of the half step before it
    void follow(const LoadSegment& segment, LAMMPS_NS::bigint first_step, LAMMPS_NS::bigint now);

    /// All that it has gathered, for a checkpoint.
    std::vector<double> state() const;
    void restore(const std::vector<double>& state);

    /// From the next step on c grows by that much per unit of strain.
    void steer(double growth) { growth_ = growth; }
    /// By how much c is to change its growth where the sample answers as a viscous one.
    double growth_without_stress() const;
    /// Whether there is to be no mean stress across, for a kernel that finds the velocities.
    void carry_no_stress(bool none) { carries_no_stress_ = none; }
    /// Of a kernel that finds the velocities: the sides move on for a part of a step [s].
    void move(double part);

    int setmask() override;
    void init() override;
    void post_integrate() override;
    void setup(int flag) override { post_force(flag); }
    void post_force(int) override;

 private:
    void set_rates(double time);
    void look_ahead();
    void place();
    double time() const { return update->dt * static_cast<double>(update->ntimestep - first_step_); }

    LoadSegment segment_;
    LAMMPS_NS::bigint first_step_ = 0;
    double growth_ = 0, correction_ = 0;
    bool carries_no_stress_ = false;
    double middle_[2] = {0, 0}, edge_[2] = {0, 0};
};

}  // namespace tomodem::plugin
