#include "solver_plugin/liggghts/surfaces.hpp"

#include <algorithm>

#include "solver_plugin/liggghts/law_pair.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

void FixSurface::place(const TriangleMesh& mesh, const Motion& motion) {
    tree_ = std::make_unique<TriangleTree>(mesh);
    motion_ = motion;
}

int FixSurface::setmask() {
    return FixConst::POST_FORCE;
}

Vec3 FixSurface::displacement(double time) const {
    return std::max(0.0, std::min(time, motion_.stop) - motion_.start) * motion_.velocity;
}

/// In the surface's own frame.
Vec3 FixSurface::place_of(int i, const Vec3& displacement) const {
    return Vec3(atom->x[i][0], atom->x[i][1], atom->x[i][2]) - displacement;
}

FixSurface::Forces FixSurface::take_forces() {
    const Forces taken = forces_;
    forces_ = {};
    return taken;
}

std::int64_t FixSurface::particles_within(double distance) const {
    const Vec3 moved = displacement(clock_.at(update->ntimestep));
    std::int64_t count = 0;
    std::vector<int> found;
    for (int i = 0; i < atom->nlocal; ++i) {
        found.clear();
        tree_->near(place_of(i, moved), distance, found);
        if (!found.empty()) ++count;
    }
    return count;
}

void FixSurface::choose_candidates(const Vec3& moved) {
    candidates_.clear();
    std::vector<int> found;
    for (int i = 0; i < atom->nlocal; ++i) {
        found.clear();
        // Half a skin for the surface, and a whole one for a particle that swings from side to side between builds.
        tree_->near(place_of(i, moved), atom->radius[i] + 1.5 * neighbor->skin, found);
        if (!found.empty()) candidates_.push_back({i, found});
    }
    chosen_at_ = moved;
}

void FixSurface::add_walls(double start, double interval, int number, std::vector<NearWall>& walls) const {
    const double time = clock_.at(update->ntimestep) + start;
    const Vec3 moved = displacement(time);
    const Vec3 velocity = (displacement(time + interval) - moved) / interval;
    std::vector<int> found;
    std::vector<SurfaceContact> contacts;
    for (int i = 0; i < atom->nlocal; ++i) {
        found.clear();
        tree_->near(place_of(i, moved), atom->radius[i], found);
        if (found.empty()) continue;
        tree_->contacts(found, place_of(i, moved), atom->radius[i], contacts);
        for (std::size_t k = 0; k < contacts.size(); ++k) {
            const Vec3& normal = contacts[k].direction;
            walls.push_back({i,
                             number + static_cast<int>(k),
                             {normal[0], normal[1], normal[2]},
                             contacts[k].distance,
                             normal.dot(velocity)});
        }
    }
}

void FixSurface::post_force(int) {
    const Vec3 moved = displacement(clock_.at(update->ntimestep));
    const bool outrun = (moved - chosen_at_).norm() > 0.5 * neighbor->skin;
    if (neighbor->ago == 0 || update->setupflag || outrun) choose_candidates(moved);

    const LawPair& pair = *LawPair::of(*lmp);
    Vec3 velocity;
    if (pair.kernel().finds_velocities()) {
        const double interval = pair.kernel().interval();
        velocity = (displacement(clock_.at(update->ntimestep) + interval) - moved) / interval;
    } else {
        // The particles hold their half-step velocities when forces are computed: so does the surface.
        velocity = (moved - displacement(clock_.at(update->ntimestep - 1))) / update->dt;
    }
    Vec3 total = Vec3::Zero();
    virial_ = 0;
    const bool tallies = tally_step_ == update->ntimestep;
    if (tallies) tally_.assign(static_cast<std::size_t>(atom->nlocal), {});
    for (const Candidate& candidate : candidates_) {
        const int i = candidate.particle;
        tree_->contacts(candidate.triangles, place_of(i, moved), atom->radius[i], contacts_);
        const Vec3 relative = Vec3(atom->v[i][0], atom->v[i][1], atom->v[i][2]) - velocity;
        for (const SurfaceContact& contact : contacts_) {
            const Vec3 on_particle =
                pair.wall_force(i, contact.distance, contact.direction.data(), contact.direction.dot(relative)) *
                contact.direction;
            for (int axis = 0; axis < 3; ++axis) atom->f[i][axis] += on_particle[axis];
            total += on_particle;
            const Vec3 lever = (pair.kernel().face() - contact.distance) * contact.direction;
            virial_ += on_particle[2] * lever[2];
            if (!tallies) continue;
            constexpr int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2};
            for (int k = 0; k < 6; ++k)
                tally_[static_cast<std::size_t>(i)][k] += on_particle[first[k]] * lever[second[k]];
        }
    }
    if (update->setupflag) return;
    forces_.sum += total;
    ++forces_.steps;
}

}  // namespace tomodem::plugin
