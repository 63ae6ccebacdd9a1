#include "solver_plugin/pairs/packed_particles.hpp"

namespace tomodem::plugin {

void PackedParticles::integrate(const MovingView& particles, double kick, double drift) {
    if (rows_.size() < static_cast<std::size_t>(particles.count)) make_room(particles.count);
    const double limit = 0.25 * inner_skin_ * inner_skin_;
    const float* const listed_at = list_.listed_at();
    strayed_.clear();
    for (int i = 0; i < particles.count; ++i) {
        const double per_force = kick / particles.mass[i];
        double* const x = particles.position + 3 * static_cast<std::ptrdiff_t>(i);
        double* const v = particles.velocity + 3 * static_cast<std::ptrdiff_t>(i);
        const double* const f = particles.force + 3 * static_cast<std::ptrdiff_t>(i);
        double moved = 0;
        for (int c = 0; c < 3; ++c) {
            v[c] += per_force * f[c];
            x[c] += drift * v[c];
            rows_[i].position[c] = x[c];
            rows_[i].velocity[c] = v[c];
            moved += (x[c] - listed_at[3 * i + c]) * (x[c] - listed_at[3 * i + c]);
        }
        if (moved > limit) strayed_.push_back(i);
    }
    integrated_ = particles.count;
}

void PackedParticles::copy(const ParticleView& particles, int first) {
    const double limit = 0.25 * inner_skin_ * inner_skin_;
    const float* const listed_at = list_.listed_at();
    for (int i = first; i < particles.count; ++i) {
        Row& row = rows_[i];
        double moved = 0;
        for (int c = 0; c < 3; ++c) {
            row.position[c] = particles.position[3 * i + c];
            row.velocity[c] = particles.velocity[3 * i + c];
            const double step = row.position[c] - listed_at[3 * i + c];
            moved += step * step;
        }
        if (moved > limit) strayed_.push_back(i);
    }
}

void PackedParticles::make_room(int count) {
    rows_.resize(count, Row{});
    forces_.resize(count, Force{});
    list_.make_room(count);
}

bool PackedParticles::follow(const ParticleView& particles, double reach, bool renumbered,
                             const ContactMemory* memory) {
    if (rows_.size() < static_cast<std::size_t>(particles.count)) make_room(particles.count);
    if (renumbered || integrated_ == 0) {
        integrated_ = 0;
        strayed_.clear();
    }
    copy(particles, integrated_);
    integrated_ = 0;
    if (!renumbered && (strayed_.empty() || list_.mend(particles, strayed_, memory))) return false;
    for (int i = 0; i < particles.count; ++i) rows_[i].velocity[3] = particles.radius[i];
    list_.make(particles, reach + inner_skin_, memory);
    return true;
}

void PackedParticles::give_forces(const ParticleView& particles, double* forces) {
    for (int i = 0; i < particles.count; ++i) {
        if (i < particles.local_count)
            for (int c = 0; c < 3; ++c) forces[3 * i + c] += forces_[i].component[c];
        forces_[i] = {};
    }
}

}  // namespace tomodem::plugin
