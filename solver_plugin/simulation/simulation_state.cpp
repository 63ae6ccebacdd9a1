#include "solver_plugin/simulation/simulation_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "core/base/error.hpp"

namespace tomodem::plugin {
namespace {

/// Radius over the mean of particle `id`: a normal distribution cut at three standard deviations, the same everywhere.
double radius_factor(std::int64_t id, double dispersion) {
    if (dispersion == 0) return 1;
    std::mt19937_64 random(static_cast<std::uint64_t>(id) * 0x9E3779B97F4A7C15ULL);
    std::normal_distribution<double> normal;
    double deviate = normal(random);
    while (std::abs(deviate) > 3) deviate = normal(random);
    return 1 + dispersion * deviate;
}

/// Growth of the periodic sides per unit of strain over the lateral pressure in units of k_rep / 2 r_s: the mean stress
/// across the load dies out over about 0.005 of strain.
constexpr double side_gain = 500;

}  // namespace

Simulation::State::State(const Packing& sample, const Model& model, int axis, MPI_Comm communicator)
    : communicator(communicator), model(model), axis(axis), session(communicator) {
    MPI_Comm_rank(communicator, &rank);
    scale = model.seed_radius / sample.seed_radius;
    count = static_cast<std::int64_t>(sample.size());
    sample_volume = sample.box.volume();
    material_clock.time_step = run_clock.time_step = model.time_step;
    if (model.objects_only_push) object = sample.object;
    for (const PhaseModel& phase : model.phases)
        hardening.push_back(phase.hardening ? phase.hardening->factor(0) : 1.0);
    for (const double radius : sample.radius) radius_factors.push_back(radius / sample.seed_radius);
    if (model.radius_dispersion > 0 && sample.radius.empty())
        for (const std::int64_t id : sample.id) radius_factors.push_back(radius_factor(id, model.radius_dispersion));
}

int Simulation::State::type_of(std::int32_t label) const {
    for (std::size_t k = 0; k < model.phases.size(); ++k)
        if (model.phases[k].label == label) return static_cast<int>(k) + 1;
    throw InvalidInput(fmt::format("the model has no phase with label {}", label));
}

void Simulation::State::add_sides() {
    session.command("fix sides all tomodem/lateral");
    sides = static_cast<FixLateralBox*>(session.lmp().modify->find_fix_id("sides"));
    sides->carry_no_stress(model.lateral == Lateral::periodic);
}

void Simulation::State::add_planes() {
    if (planes != nullptr) return;
    session.command("fix planes all tomodem/planes");
    planes = static_cast<FixPlanes*>(session.lmp().modify->find_fix_id("planes"));
}

void Simulation::State::use_laws() {
    pair->use({model, hardening, relaxing, !radius_factors.empty()});
}

void Simulation::State::step_by(double time_step) {
    if (session.lmp().update->dt == time_step) return;
    session.command(fmt::format("timestep {:.17g}", time_step));
    ready = false;
}

void Simulation::State::harden(double time) {
    bool changed = false;
    for (std::size_t k = 0; k < model.phases.size(); ++k) {
        if (!model.phases[k].hardening) continue;
        const double factor = model.phases[k].hardening->factor(time);
        if (factor == hardening[k]) continue;
        for (int i = 0; i < atom().nlocal; ++i)
            if (atom().type[i] == static_cast<int>(k) + 1) {
                atom().rmass[i] *= factor / hardening[k];
                atom().density[i] *= factor / hardening[k];
            }
        hardening[k] = factor;
        changed = true;
    }
    if (changed) use_laws();
}

void Simulation::State::remember_contacts() {
    session.command("fix contact all tomodem/contact");
    ready = false;  // the pair style finds it when it is set up
    contact = static_cast<FixContact*>(session.lmp().modify->find_fix_id("contact"));
    contact->memory().set_law({.min_outward = law::SelfContact::outward_over_seed * model.seed_radius});
    if (std::isfinite(model.healing_time)) contact->heal_after(std::llround(model.healing_time / model.time_step));
}

void Simulation::State::steer_sides() {
    if (model.law->traits().damping == Damping::law) {
        sides->steer(sides->growth_without_stress());
        return;
    }
    const LAMMPS_NS::Domain& domain = *session.lmp().domain;
    const FixPlanes::Motion& motion = planes->motion();
    const double height = motion.initial_height * std::exp(segment.strain_at(time_in_segment()));
    const double pressure = total(pair->lateral_virial()) / (domain.xprd * domain.yprd * height);
    double stiffest = 0;
    for (const PhaseModel& phase : model.phases) stiffest = std::max(stiffest, phase.pair.repulsive_stiffness);
    const double reduced = pressure / (stiffest / (2 * model.seed_radius));
    sides->steer(std::clamp(side_gain * reduced, -1.0, 1.0));
}

void Simulation::State::carry_along(double rate) {
    const LAMMPS_NS::Atom& atoms = atom();
    const double slope[3] = {-0.5 * rate, -0.5 * rate, rate};
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) atoms.v[i][c] += slope[c] * (atoms.x[i][c] - planes->motion().centre[c]);
}

void Simulation::State::scale_velocities(double factor) {
    const LAMMPS_NS::Atom& atoms = atom();
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) atoms.v[i][c] *= factor;
}

void Simulation::State::shake(double deviation) {
    const LAMMPS_NS::Atom& atoms = atom();
    for (int i = 0; i < atoms.nlocal; ++i) {
        std::seed_seq seed{atoms.tag[i], 0x5eed};
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal(0, deviation);
        for (int c = 0; c < 3; ++c) atoms.v[i][c] += normal(random);
    }
}

void Simulation::State::create_particles(const Packing& sample) {
    const LAMMPS_NS::Domain& domain = *session.lmp().domain;
    for (std::size_t k = 0; k < sample.size(); ++k) {
        Vec3 point = to_solver(sample.position[k]);
        if (model.lateral != Lateral::free)
            for (int c = 0; c < 2; ++c) {
                point[c] -= std::floor((point[c] - domain.boxlo[c]) / domain.prd[c]) * domain.prd[c];
                if (point[c] >= domain.boxhi[c]) point[c] = domain.boxlo[c];
            }
        bool mine = true;
        for (int c = 0; c < 3; ++c) mine = mine && point[c] >= domain.sublo[c] && point[c] < domain.subhi[c];
        if (!mine) continue;
        create_particle(type_of(sample.species[k]), static_cast<int>(k) + 1, point.data());
    }
    count_particles();
}

void Simulation::State::create_particle(int type, int tag, double* point) {
    LAMMPS_NS::Atom& atoms = atom();
    atoms.avec->create_atom(type, point);
    const int i = atoms.nlocal - 1;
    atoms.tag[i] = tag;
    atoms.radius[i] = model.crown_radius * (radius_factors.empty() ? 1.0 : radius_factors[tag - 1]);
}

void Simulation::State::count_particles() {
    LAMMPS_NS::Atom& atoms = atom();
    atoms.natoms = static_cast<LAMMPS_NS::bigint>(std::llround(total(atoms.nlocal)));
    if (atoms.natoms != count)
        throw InvalidInput(fmt::format("only {} of {} particles could be placed in the solver", atoms.natoms, count));
    atoms.map_init();
    atoms.map_set();
}

double Simulation::State::face(double low, double high, double wanted, double inward) {
    double outside = inward > 0 ? low : high, inside = inward > 0 ? high : low;
    while (std::abs(inside - outside) > 1e-9 * model.seed_radius) {
        const double middle = (inside + outside) / 2;
        double beyond = 0;
        for (int i = 0; i < atom().nlocal; ++i) beyond += inward * (atom().x[i][2] - middle) <= 0;
        (total(beyond) < wanted ? outside : inside) = middle;
    }
    return inside;
}

void Simulation::State::set_up_if_needed() {
    if (ready) return;
    builds_before = builds();
    counting = true;
    session.command("run 0 post no");
    ready = true;
}
}  // namespace tomodem::plugin
