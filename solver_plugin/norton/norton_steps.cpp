#include "solver_plugin/norton/norton_steps.hpp"

namespace tomodem::plugin {

NortonSteps::NortonSteps() {
    forces_.set_interval(0);  // the elastic forces of the present places
}

void NortonSteps::set_law(const law::Norton& law, double list_skin) {
    forces_.set_law(law);
    forces_.set_skin(list_skin * law::NortonConstants::crown * law.seed_diameter);
}

void NortonSteps::add_forces(const ParticleView& particles, const NeighbourView&, const PairStep& step, double* forces,
                             ContactMemory*, const UsePair* use) {
    forces_.set_rate(load_rate(0));
    forces_.place(particles, step.renumbered);
    // One more than there are: a process without particles takes part in every exchange.
    velocity_.resize(static_cast<std::size_t>(particles.count) + 1);
    for (int i = 0; i < particles.count; ++i)
        for (int c = 0; c < 3; ++c) velocity_[i][c] = static_cast<float>(particles.velocity[3 * i + c]);
    forces_.find_corrected(velocity_.data());
    balance_films(particles, step.time_step);
    for (int i = 0; i < particles.local_count; ++i)
        for (int c = 0; c < 3; ++c) forces[3 * i + c] += forces_.net()[i][c];
    films_.add_forces(forces);
    if (use != nullptr) forces_.for_each_force(velocity_.data(), *use);
}

void NortonSteps::balance_films(const ParticleView& particles, double time_step) {
    forces_.lay_films(surroundings().planes(0, time_step), films_);
    films_.solve(
        particles, forces_.net(), time_step,
        [this](void* first, std::size_t stride, std::size_t size) { carry(first, stride, size); }, surroundings());
    forces_.add_to_tractions(films_);
}

void NortonSteps::pair_forces(const ParticleView&, const NeighbourView&, const ContactMemory*,
                              const UsePair& use) const {
    forces_.for_each_force(velocity_.data(), use);
}

/// A film that was not known before add_forces() acts on the particle alone.
double NortonSteps::wall_force(const WallContact& contact) const {
    if (contact.plane >= 0) return films_.plane_force(contact.particle, contact.plane);
    return law::norton_wall_force(law(), law().materials[contact.type - 1].strength, contact.distance, contact.rate,
                                  contact.other_force, contact.time_step_over_mass);
}

}  // namespace tomodem::plugin
