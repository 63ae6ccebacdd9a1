#include "solver_plugin/liggghts/planes.hpp"

#include <cmath>

#include "solver_plugin/liggghts/law_pair.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

int FixPlanes::setmask() {
    return FixConst::POST_FORCE;
}

FixPlanes::Forces FixPlanes::take_forces() {
    const Forces taken = forces_;
    forces_ = {};
    return taken;
}

void FixPlanes::choose_candidates(double low, double high) {
    near_low_.clear();
    near_high_.clear();
    const PairKernel& kernel = LawPair::of(*lmp)->kernel();
    for (int i = 0; i < atom->nlocal; ++i) {
        // Half a skin for the plane, and a whole one for a particle that swings from side to side between builds.
        const double reach = kernel.plane_reach(atom->radius[i]) + 1.5 * neighbor->skin;
        if (atom->x[i][2] - low < reach) near_low_.push_back(i);
        if (high - atom->x[i][2] < reach) near_high_.push_back(i);
    }
    chosen_low_ = low;
    chosen_high_ = high;
}

double FixPlanes::press(const std::vector<int>& candidates, double plane, double velocity, double inward) {
    const LawPair& pair = *LawPair::of(*lmp);
    double total = 0;
    for (int i : candidates) {
        const double distance = inward * (atom->x[i][2] - plane);
        if (distance >= pair.kernel().plane_reach(atom->radius[i])) continue;
        const double normal[3] = {0, 0, inward};
        const double normal_force =
            pair.wall_force(i, distance, normal, inward * (atom->v[i][2] - velocity), inward > 0 ? 0 : 1);
        atom->f[i][2] += inward * normal_force;
        total += normal_force;
        const double part = -normal_force * (distance - pair.kernel().face());
        virial_ += part;
        if (tally_step_ == update->ntimestep) tally_[static_cast<std::size_t>(i)] += part;
    }
    return total;
}

/// The force that accelerates every particle as the flow about the centre: uniaxial, volume kept.
void FixPlanes::take_along(double time) {
    const double half = 0.5 * update->dt;
    const double growth = (motion_.segment.rate_at(time + half) - motion_.segment.rate_at(time - half)) / update->dt;
    const double slope[3] = {-0.5 * growth, -0.5 * growth, growth};
    for (int i = 0; i < atom->nlocal; ++i)
        for (int axis = 0; axis < 3; ++axis)
            atom->f[i][axis] += atom->rmass[i] * slope[axis] * (atom->x[i][axis] - motion_.centre[axis]);
}

double FixPlanes::half_gap(double time) const {
    return 0.5 * motion_.initial_height * std::exp(motion_.segment.strain_at(time)) + motion_.seed_radius;
}

void FixPlanes::add_walls(double start, double interval, int first, int count, std::vector<NearWall>& walls) const {
    const double from = half_gap(time() + start);
    const double velocity = (half_gap(time() + start + interval) - from) / interval;
    const PairKernel& kernel = LawPair::of(*lmp)->kernel();
    for (int i = 0; i < count; ++i) {
        const double height = atom->x[i][2] - motion_.centre[2];
        const double reach = kernel.plane_reach(atom->radius[i]);
        if (from + height < reach) walls.push_back({i, first, {0, 0, 1}, from + height, -velocity});
        if (from - height < reach) walls.push_back({i, first + 1, {0, 0, -1}, from - height, -velocity});
    }
}

std::array<double, 3> FixPlanes::growth(double before, double interval) const {
    const double from = time() - before;
    const double now = motion_.segment.rate_at(from), next = motion_.segment.rate_at(from + interval);
    const double change = now != 0 ? next / now : 1;
    return {change * (1 - 0.5 * now * interval) - 1, change * (1 - 0.5 * now * interval) - 1,
            change * (1 + now * interval) - 1};
}

void FixPlanes::post_force(int) {
    const LoadSegment& segment = motion_.segment;
    const double time = this->time();
    const double gap = half_gap(time);
    const double low = motion_.centre[2] - gap, high = motion_.centre[2] + gap;
    double velocity = 0;
    if (LawPair::of(*lmp)->kernel().finds_velocities()) {
        const double interval = LawPair::of(*lmp)->kernel().interval();
        velocity = (half_gap(time + interval) - gap) / interval;
    } else {
        // The particles hold their half-step velocities when forces are computed: so do the planes.
        const double half_step = time - 0.5 * update->dt;
        velocity = 0.5 * segment.rate_at(half_step) * motion_.initial_height * std::exp(segment.strain_at(half_step));
    }

    // Particles move by less than half a skin between two builds; a plane may outrun them.
    const bool outrun = std::abs(high - chosen_high_) > 0.5 * neighbor->skin;
    if (neighbor->ago == 0 || update->setupflag || outrun) choose_candidates(low, high);

    if (tally_step_ == update->ntimestep) tally_.assign(static_cast<std::size_t>(atom->nlocal), 0.0);
    virial_ = 0;
    const double on_bottom = press(near_low_, low, -velocity, 1);
    const double on_top = press(near_high_, high, velocity, -1);
    if (segment.affine) take_along(time);
    if (update->setupflag) return;
    forces_.bottom -= on_bottom;
    forces_.top -= on_top;
    ++forces_.steps;
}

}  // namespace tomodem::plugin
