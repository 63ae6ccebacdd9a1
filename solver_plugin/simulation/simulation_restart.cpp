#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "solver_plugin/simulation/simulation_state.hpp"

namespace tomodem::plugin {

void Simulation::save(Checkpoint& checkpoint) const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    const LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    const auto mine = static_cast<std::size_t>(atoms.nlocal);
    ParticleState& particles = checkpoint.particles;
    particles.tag.assign(atoms.tag, atoms.tag + mine);
    particles.type.assign(atoms.type, atoms.type + mine);
    particles.image.assign(atoms.image, atoms.image + mine);
    particles.position.assign(mine > 0 ? atoms.x[0] : nullptr, mine > 0 ? atoms.x[0] + 3 * mine : nullptr);
    particles.velocity.assign(mine > 0 ? atoms.v[0] : nullptr, mine > 0 ? atoms.v[0] + 3 * mine : nullptr);
    particles.memory_length.assign(mine, 0);
    particles.memory.clear();
    for (std::size_t i = 0; s.contact != nullptr && i < mine; ++i) {
        const ContactMemory& memory = s.contact->memory();
        const std::size_t before = particles.memory.size();
        for (int c = 0; c < 3; ++c) particles.memory.push_back(std::bit_cast<std::int64_t>(memory.outward()[i][c]));
        for (const auto& one : memory.interfaces(static_cast<int>(i)))
            particles.memory.insert(particles.memory.end(), {one.partner, one.since});
        particles.memory_length[i] = static_cast<std::int32_t>(particles.memory.size() - before);
    }
    checkpoint.numbers["solver_material_clock"] = numbers_of(s.material_clock);
    checkpoint.numbers["solver_run_clock"] = numbers_of(s.run_clock);
    checkpoint.numbers["solver_loading"] = {s.loading ? 1.0 : 0.0};
    checkpoint.numbers["solver_centre"] = {s.centre[0], s.centre[1], s.centre[2]};
    checkpoint.numbers["solver_hardening"] = s.hardening;
    checkpoint.numbers["solver_step"] = {static_cast<double>(step())};
    checkpoint.numbers["solver_box"] = {domain.boxlo[0], domain.boxlo[1], domain.boxlo[2],
                                        domain.boxhi[0], domain.boxhi[1], domain.boxhi[2]};
    if (s.planes != nullptr)
        checkpoint.numbers["solver_planes"] = {s.planes->motion().centre[0], s.planes->motion().centre[1],
                                               s.planes->motion().centre[2], s.planes->motion().initial_height};
    if (s.sides != nullptr) checkpoint.numbers["solver_sides"] = s.sides->state();
}

void Simulation::restore(const FoundCheckpoint& found) {
    State& s = *state_;
    const ParticleState& particles = found.checkpoint.particles;
    LAMMPS_NS::Atom& atoms = s.atom();
    LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    atoms.map_clear();
    atoms.nlocal = atoms.nghost = 0;
    for (std::size_t k = 0; k < particles.tag.size(); ++k) {
        double point[3];
        std::copy_n(particles.position.data() + 3 * k, 3, point);
        s.create_particle(particles.type[k], particles.tag[k], point);
        std::copy_n(particles.velocity.data() + 3 * k, 3, atoms.v[atoms.nlocal - 1]);
        atoms.image[atoms.nlocal - 1] = particles.image[k];
    }
    s.count_particles();
    s.hardening = found.checkpoint.numbers.at("solver_hardening");
    s.material_clock = clock_of(found.checkpoint.numbers.at("solver_material_clock"));
    s.run_clock = clock_of(found.checkpoint.numbers.at("solver_run_clock"));
    s.loading = found.checkpoint.number("solver_loading") != 0;
    std::copy_n(found.checkpoint.numbers.at("solver_centre").data(), 3, s.centre.data());
    rest();
    if (const auto sides = found.checkpoint.numbers.find("solver_sides"); sides != found.checkpoint.numbers.end()) {
        s.add_sides();
        s.sides->restore(sides->second);
    }
    if (const auto planes = found.checkpoint.numbers.find("solver_planes"); planes != found.checkpoint.numbers.end()) {
        s.add_planes();
        FixPlanes::Motion motion;
        std::copy_n(planes->second.data(), 3, motion.centre);
        motion.initial_height = planes->second.at(3);
        motion.seed_radius = s.model.seed_radius;
        motion.first_step = step();
        s.planes->move(motion);
    }
    if (s.model.self_contact && s.loading) s.remember_contacts();
    if (s.contact != nullptr) {
        ContactMemory& memory = s.contact->memory();
        memory.resize(atoms.nlocal, 0);
        const std::int64_t* word = particles.memory.data();
        for (int i = 0; i < atoms.nlocal; ++i) {
            if (particles.memory_length[i] == 0) continue;  // of a run without self-contact: all that touch are inside
            for (int c = 0; c < 3; ++c) memory.outward()[i][c] = std::bit_cast<double>(*word++);
            auto& interfaces = memory.interfaces(i);
            interfaces.resize(static_cast<std::size_t>(particles.memory_length[i] - 3) / 2);
            for (auto& one : interfaces) {
                one.partner = *word++;
                one.since = *word++;
            }
        }
    }
    const std::vector<double>& box = found.checkpoint.numbers.at("solver_box");
    std::copy_n(box.data(), 3, domain.boxlo);
    std::copy_n(box.data() + 3, 3, domain.boxhi);
    domain.set_global_box();
    domain.set_local_box();
    if (!found.same_processes) LAMMPS_NS::Irregular(&s.session.lmp()).migrate_atoms();
    s.session.command(fmt::format("reset_timestep {:.0f}", found.checkpoint.number("solver_step")));
    s.use_laws();
    s.ready = false;
}

void Simulation::rest() {
    // Masses that hardened step by step have rounding errors of their own.
    state_->set_masses([](const PhaseModel& phase) { return phase.natural_period; });
}

}  // namespace tomodem::plugin
