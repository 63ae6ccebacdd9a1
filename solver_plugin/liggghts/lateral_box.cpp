#include "solver_plugin/liggghts/lateral_box.hpp"

#include <algorithm>
#include <cmath>

#include "solver_plugin/liggghts/law_pair.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

namespace {

/// Fall of the pressure across with c's growth per unit of strain, over the flow stress, in a viscous sample: 4.2 by
/// the law's bulk and shear viscosities, and what the density adds in a step.
constexpr double viscous_answer = 4.5;
/// Mean stress across over the flow stress that is little enough, and velocities that are solved for to get there.
constexpr double little_stress = 5e-3;
constexpr int most_solutions = 5;

bool finds_velocities(const LAMMPS& lmp) {
    return LawPair::of(lmp)->kernel().finds_velocities();
}

}  // namespace

FixLateralBox::FixLateralBox(LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {
    box_change_size = 1;
}

void FixLateralBox::begin() {
    for (int axis = 0; axis < 2; ++axis) {
        middle_[axis] = (domain->boxlo[axis] + domain->boxhi[axis]) / 2;
        edge_[axis] = domain->boxhi[axis] - domain->boxlo[axis];
    }
}

void FixLateralBox::follow(const LoadSegment& segment, bigint first_step, bigint now) {
    segment_ = segment;
    first_step_ = first_step;
    if (finds_velocities(*lmp))
        look_ahead();
    else
        set_rates(now > first_step ? update->dt * static_cast<double>(now - first_step) - 0.5 * update->dt : 0.0);
}

std::vector<double> FixLateralBox::state() const {
    return {growth_, correction_, middle_[0], middle_[1], edge_[0], edge_[1]};
}

void FixLateralBox::restore(const std::vector<double>& state) {
    growth_ = state.at(0);
    correction_ = state.at(1);
    for (int axis = 0; axis < 2; ++axis) {
        middle_[axis] = state.at(2 + axis);
        edge_[axis] = state.at(4 + axis);
    }
}

int FixLateralBox::setmask() {
    return FixConst::POST_INTEGRATE | FixConst::POST_FORCE;
}

void FixLateralBox::init() {
    // Only a fix called "deform" is asked for these by LIGGGHTS itself.
    domain->deform_vremap = 1;
    domain->deform_groupbit = groupbit;
    atom->avec->init();
}

void FixLateralBox::set_rates(double time) {
    const double rate = segment_.rate_at(time), strain = segment_.strain_at(time);
    for (int axis = 0; axis < 2; ++axis) {
        const double edge = edge_[axis] * std::exp(correction_ - 0.5 * strain);
        domain->h_rate[axis] = (growth_ * std::abs(rate) - 0.5 * rate) * edge;
        domain->h_ratelo[axis] = -0.5 * domain->h_rate[axis];
    }
}

/// The rate at which the box comes to where it is to be at the end of the step to come.
void FixLateralBox::look_ahead() {
    const double change = segment_.strain_at(time() + update->dt) - segment_.strain_at(time());
    const double growth = std::expm1(growth_ * std::abs(change) - 0.5 * change);
    for (int axis = 0; axis < 2; ++axis) {
        domain->h_rate[axis] = growth * (domain->boxhi[axis] - domain->boxlo[axis]) / update->dt;
        domain->h_ratelo[axis] = -0.5 * domain->h_rate[axis];
    }
}

void FixLateralBox::place() {
    for (int axis = 0; axis < 2; ++axis) {
        const double half = 0.5 * edge_[axis] * std::exp(correction_ - 0.5 * segment_.strain_at(time()));
        domain->boxlo[axis] = middle_[axis] - half;
        domain->boxhi[axis] = middle_[axis] + half;
    }
    domain->set_global_box();
    domain->set_local_box();
}

void FixLateralBox::move(double part) {
    for (int axis = 0; axis < 2; ++axis) {
        domain->boxlo[axis] -= 0.5 * part * domain->h_rate[axis];
        domain->boxhi[axis] += 0.5 * part * domain->h_rate[axis];
    }
    domain->set_global_box();
    domain->set_local_box();
}

void FixLateralBox::post_integrate() {
    if (finds_velocities(*lmp)) {
        correction_ += growth_ * std::abs(segment_.strain_at(time()) - segment_.strain_at(time() - update->dt));
        place();
        look_ahead();
        return;
    }
    const double half_step = time() - 0.5 * update->dt;
    correction_ += growth_ * std::abs(segment_.rate_at(half_step)) * update->dt;
    place();
    // Velocities are those of the half step when forces are computed.
    set_rates(half_step);
}

double FixLateralBox::growth_without_stress() const {
    const Vec3 virial = LawPair::of(*lmp)->virial();
    const double across = (virial[0] + virial[1]) / 2, flow = std::abs(virial[2] - across);
    return flow > 0 ? std::clamp(growth_ + across / (viscous_answer * flow), -1.0, 1.0) : growth_;
}

/// A secant that begins with a viscous sample's answer.
void FixLateralBox::post_force(int) {
    LawPair& pair = *LawPair::of(*lmp);
    const double rate = segment_.rate_at(time());
    if (!carries_no_stress_ || !pair.kernel().finds_velocities() || rate == 0) return;
    double before = 0, change = 0;
    for (int solutions = 0; solutions < most_solutions; ++solutions) {
        const Vec3 virial = pair.virial();
        const double across = (virial[0] + virial[1]) / 2, flow = std::abs(virial[2] - across);
        if (std::abs(across) <= little_stress * flow) return;
        double answer = viscous_answer * flow;
        if (change != 0) answer = std::clamp((before - across) / change, 0.2 * answer, 5 * answer);
        const double growth = std::clamp(growth_ + across / answer, -1.0, 1.0);
        change = growth - growth_;
        if (change == 0) return;
        before = across;
        growth_ = growth;
        look_ahead();
        for (int i = 0; i < atom->nlocal; ++i)
            for (int axis = 0; axis < 2; ++axis)
                atom->v[i][axis] += change * std::abs(rate) * (atom->x[i][axis] - middle_[axis]);
        pair.solve_again();
    }
}

}  // namespace tomodem::plugin
