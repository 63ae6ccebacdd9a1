#include "solver_plugin/liggghts/lateral_box.hpp"

#include <cmath>

namespace tomodem::plugin {

using namespace LAMMPS_NS;

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
    return FixConst::POST_INTEGRATE;
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

void FixLateralBox::post_integrate() {
    const double time = update->dt * static_cast<double>(update->ntimestep - first_step_);
    const double half_step = time - 0.5 * update->dt;
    correction_ += growth_ * std::abs(segment_.rate_at(half_step)) * update->dt;
    for (int axis = 0; axis < 2; ++axis) {
        const double half = 0.5 * edge_[axis] * std::exp(correction_ - 0.5 * segment_.strain_at(time));
        domain->boxlo[axis] = middle_[axis] - half;
        domain->boxhi[axis] = middle_[axis] + half;
    }
    domain->set_global_box();
    domain->set_local_box();
    // Velocities are those of the half step when forces are computed.
    set_rates(half_step);
}

}  // namespace tomodem::plugin
