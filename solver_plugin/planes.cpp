#include "solver_plugin/planes.hpp"

#include <cmath>

namespace tomodem::plugin {

using namespace LAMMPS_NS;

int FixPlanes::setmask() {
    return FixConst::POST_FORCE;
}

double FixPlanes::strain_at(bigint step) const {
    return motion_.strain + motion_.rate * update->dt * static_cast<double>(step - motion_.first_step);
}

double FixPlanes::half_gap_at(bigint step) const {
    return 0.5 * motion_.initial_height * std::exp(strain_at(step)) + motion_.seed_radius;
}

FixPlanes::Forces FixPlanes::take_forces() {
    const Forces taken = forces_;
    forces_ = {};
    return taken;
}

void FixPlanes::choose_candidates(double low, double high) {
    near_low_.clear();
    near_high_.clear();
    for (int i = 0; i < atom->nlocal; ++i) {
        const double reach = atom->radius[i] + neighbor->skin;
        if (atom->x[i][2] - low < reach) near_low_.push_back(i);
        if (high - atom->x[i][2] < reach) near_high_.push_back(i);
    }
    chosen_low_ = low;
    chosen_high_ = high;
}

double FixPlanes::press(const std::vector<int>& candidates, double plane, double velocity, double inward) {
    double total = 0;
    for (int i : candidates) {
        const double distance = inward * (atom->x[i][2] - plane);
        if (distance >= atom->radius[i]) continue;
        law::Wall law = laws_[atom->type[i]];
        law.seed_distance *= atom->radius[i] / law.crown_distance;
        law.crown_distance = atom->radius[i];
        const double normal_force = law::wall_force(law, distance, inward * (atom->v[i][2] - velocity));
        atom->f[i][2] += inward * normal_force;
        total += normal_force;
        if (tally_step_ == update->ntimestep) tally_[static_cast<std::size_t>(i)] -= normal_force * distance;
    }
    return total;
}

void FixPlanes::post_force(int) {
    const double strain = strain_at(update->ntimestep);
    const double half_gap = half_gap_at(update->ntimestep);
    const double low = motion_.centre - half_gap, high = motion_.centre + half_gap;
    // The particles hold their half-step velocities when forces are computed: so do the planes.
    const double velocity =
        0.5 * motion_.rate * motion_.initial_height * std::exp(strain - 0.5 * motion_.rate * update->dt);

    // Particles move by less than half a skin between two builds; a plane may outrun them.
    const bool outrun = std::abs(high - chosen_high_) > 0.5 * neighbor->skin;
    if (neighbor->ago == 0 || update->setupflag || outrun) choose_candidates(low, high);

    if (tally_step_ == update->ntimestep) tally_.assign(static_cast<std::size_t>(atom->nlocal), 0.0);
    const double on_bottom = press(near_low_, low, -velocity, 1);
    const double on_top = press(near_high_, high, velocity, -1);
    if (update->setupflag) return;
    forces_.bottom -= on_bottom;
    forces_.top -= on_top;
    ++forces_.steps;
}

}  // namespace tomodem::plugin
