#include "solver_plugin/simulation/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "solver_plugin/simulation/simulation_state.hpp"

namespace tomodem::plugin {
namespace {

/// Drag during relaxation over the critical one. Without it the chatter of the attraction keeps the sample warm, and
/// its surface tension closes pores: a foam's struts then move by 20 seed radii instead of 2.
constexpr double relaxation_damping = 0.3;

}  // namespace

Simulation::Simulation(const Packing& sample, const Model& model, int load_axis, MPI_Comm communicator)
    : state_(std::make_unique<State>(sample, model, load_axis, communicator)) {
    State& s = *state_;
    if (sample.size() == 0) throw InvalidInput("the sample has no particle");
    Vec3 low = sample.position.front(), high = low;
    for (const Vec3& point : sample.position) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    s.centre = (low + high) / 2;
    Vec3 extent = s.scale * (high - low) + Vec3::Constant(2 * model.crown_radius);
    if (model.lateral != Lateral::free)
        for (int axis : {(load_axis + 1) % 3, (load_axis + 2) % 3}) {
            s.centre[axis] = sample.box.origin[axis] + sample.box.edges[axis] / 2;
            extent[axis] = s.scale * sample.box.edges[axis];
        }

    const auto command = [&](const std::string& line) { s.session.command(line); };
    command("atom_style granular");
    command("atom_modify map array");
    // Shrink-wrapped: nothing can leave the box, and it stays balanced over the processes while the sample spreads.
    command(model.lateral != Lateral::free ? "boundary p p m" : "boundary m m m");
    command("newton off");
    command("communicate single vel yes");
    command("units si");  // no conversion: any consistent set
    std::string corners;
    for (int c = 0; c < 3; ++c) {
        const double half = 0.5 * extent[s.turned(c)];
        corners += fmt::format(" {:.17g} {:.17g}", -half, half);
    }
    command("region everywhere block" + corners + " units box");
    command(fmt::format("create_box {} everywhere", model.phases.size()));
    s.create_particles(sample);
    const double largest_factor = sample.radius.empty()
                                      ? 1 + 3 * model.radius_dispersion
                                      : *std::max_element(s.radius_factors.begin(), s.radius_factors.end());
    // How far the box may shrink: its neighbour bins must hold a crown and a skin even where the sample is flat.
    const LawTraits& law = model.law->traits();
    const double skin = law.neighbour_skin * model.seed_radius;
    const double least = 2 * model.crown_radius * largest_factor + skin;
    LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    domain.minxlo = domain.minylo = domain.minzlo = -least;
    domain.minxhi = domain.minyhi = domain.minzhi = least;
    s.set_masses([](const PhaseModel& phase) { return phase.natural_period; });

    command(fmt::format("neighbor {:.17g} bin", skin));
    // Asked for by LIGGGHTS, read by no law of ours.
    std::string young = "peratomtype", poisson = "peratomtype";
    for (std::size_t k = 0; k < model.phases.size(); ++k) {
        young += " 5e6";
        poisson += " 0.3";
    }
    command("fix youngsModulus all property/global youngsModulus " + young);
    command("fix poissonsRatio all property/global poissonsRatio " + poisson);
    command(fmt::format("pair_style gran model {} tangential off", law.name));
    s.pair = LawPair::of(s.session.lmp());
    s.use_laws();
    if (!s.object.empty()) s.pair->separate_objects(s.object.data());
    command("pair_coeff * *");
    command(fmt::format("timestep {:.17g}", model.time_step));
    command("fix integration all tomodem/integrate");
    if (model.lateral != Lateral::free) {
        command("neigh_modify delay 0 every 1 check yes");
    } else {
        command("neigh_modify delay 0 every 2000000000 check no");
        command("fix rebuild all tomodem/rebuild");
    }
    command("fix watch all tomodem/watch");
    s.watch = static_cast<FixWatch*>(s.session.lmp().modify->find_fix_id("watch"));
    command("thermo_style custom step atoms");
    command("thermo_modify lost ignore norm no");
    command("thermo 0");
}

Simulation::~Simulation() = default;

void Simulation::begin_relaxation() {
    State& s = *state_;
    s.relaxing = true;
    s.step_by(s.model.law->relaxation_time_step(s.model));
    if (s.quasi_static()) s.ready = false;  // velocities are found again, for rest
    if (s.model.law->traits().damping == Damping::law) {
        s.use_laws();
        return;
    }
    // On the stiffness of its stiffest pair, or light soft particles fly out from between stiff ones.
    const auto period_of = [&](const PhaseModel& phase) {
        double stiffest = phase.pair.repulsive_stiffness;
        for (const PhaseModel& other : s.model.phases)
            stiffest = std::max(stiffest, law::mixed(phase.pair, other.pair).repulsive_stiffness);
        const double period = relaxation_steps_per_period * s.model.time_step;
        return period * std::sqrt(stiffest / phase.pair.repulsive_stiffness);
    };
    s.set_masses(period_of);
    // Viscous drag of a share of the critical one, 2 sqrt(k_rep m) = k_rep period / pi.
    const auto drag = [&](std::size_t k) {
        const double stiffness = s.model.phases[k].pair.repulsive_stiffness * s.hardening[k];
        return relaxation_damping * stiffness * period_of(s.model.phases[k]) / std::numbers::pi;
    };
    std::string words = fmt::format("fix drag all viscous {:.17g}", drag(0));
    for (std::size_t k = 1; k < s.model.phases.size(); ++k)
        words += fmt::format(" scale {} {:.17g}", k + 1, drag(k) / drag(0));
    s.session.command(words);
}

void Simulation::end_relaxation() {
    const Damping damping = state_->model.law->traits().damping;
    if (damping == Damping::drag) state_->session.command("unfix drag");
    state_->relaxing = false;
    if (damping == Damping::law) state_->use_laws();
    state_->step_by(state_->model.time_step);
    state_->material_clock = {0, step(), state_->model.time_step};
    LAMMPS_NS::Atom& atoms = state_->atom();
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) atoms.v[i][c] = 0;
    state_->set_masses([](const PhaseModel& phase) { return phase.natural_period; });
}

void Simulation::place_planes() {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    double low = 1e300, high = -1e300;
    for (int i = 0; i < atoms.nlocal; ++i) {
        low = std::min(low, atoms.x[i][2]);
        high = std::max(high, atoms.x[i][2]);
    }
    low = -s.largest(-low);
    high = s.largest(high);
    if (!(high > low))
        throw InvalidInput("the sample has no height along the loading axis: it needs two layers at least");
    if (s.model.law->traits().planes_pull) {
        const double layer = std::min(s.model.crown_radius - s.model.seed_radius, high - low);
        const double in_layer = static_cast<double>(s.count) * layer / (high - low);
        low = s.face(low, high, in_layer, 1) - layer;
        high = s.face(low, high, in_layer, -1) + layer;
    }
    // The sides first: they settle the forces of the particles in a step.
    if (s.model.lateral != Lateral::free) s.add_sides();
    s.add_planes();
    FixPlanes::Motion motion;
    if (s.sides != nullptr) {
        s.sides->begin();
    } else {
        for (int c = 0; c < 2; ++c) {
            double sum = 0;
            for (int i = 0; i < atoms.nlocal; ++i) sum += atoms.x[i][c];
            motion.centre[c] = s.total(sum) / static_cast<double>(s.count);
        }
    }
    motion.centre[2] = (low + high) / 2;
    motion.initial_height = high - low;
    motion.seed_radius = s.model.seed_radius;
    motion.first_step = step();
    s.planes->move(motion);
    s.use_laws();
    s.ready = false;
}

std::int64_t Simulation::place_wall(const TriangleMesh& mesh, const Wall& wall) {
    State& s = *state_;
    const std::string name = fmt::format("wall{}", s.surfaces.size());
    s.session.command(fmt::format("fix {} all tomodem/surface", name));
    auto* const fix = static_cast<FixSurface*>(s.session.lmp().modify->find_fix_id(name.c_str()));
    TriangleMesh placed = mesh;
    for (Vec3& vertex : placed.vertices) vertex = s.to_solver(vertex);
    FixSurface::Motion motion;
    for (int c = 0; c < 3; ++c) motion.velocity[c] = s.scale * wall.velocity[s.turned(c)];
    motion.start = wall.start;
    motion.stop = wall.stop;
    fix->place(placed, motion);
    if (s.loading) fix->follow(s.run_clock);
    s.surfaces.push_back(fix);
    s.use_laws();
    s.ready = false;
    return std::llround(s.total(static_cast<double>(fix->particles_within(0.5 * s.model.seed_radius))));
}

void Simulation::set_loading(const LoadSegment& segment) {
    State& s = *state_;
    const double rate_before = s.loading ? s.segment.rate_at(s.time_in_segment()) : 0.0;
    if (!s.loading) {
        // Walls stand still, and forces do not count, while the sample comes to rest between them.
        s.loading = true;
        s.material_clock = s.run_clock = {.step = step()};
        // Pairs that form before, while the sample comes to rest, are internal.
        if (s.model.self_contact) s.remember_contacts();
        take_forces();
        take_wall_forces();
    }
    continue_loading(segment, step());
    // A viscous sample is stiffer than its inertia is patient: it is given the flow that the planes begin.
    // One whose velocities are found is given a guess of them: those of before, faster or slower or backwards.
    if (s.quasi_static() && s.planes != nullptr && rate_before != 0)
        s.scale_velocities(segment.rate_at(0) / rate_before);
    else if (s.model.law->traits().starts_with_the_flow && s.planes != nullptr && !segment.affine)
        s.carry_along(segment.rate_at(0) - rate_before);
    if (s.planes != nullptr && segment.noise > 0) s.shake(segment.noise * 2 * s.model.seed_radius);
}

void Simulation::continue_loading(const LoadSegment& segment, std::int64_t first_step) {
    State& s = *state_;
    s.segment = segment;
    if (segment.time_step == 0) s.segment.time_step = s.model.time_step;
    s.segment_start = first_step;
    s.step_by(s.segment.time_step);
    if (s.quasi_static()) s.ready = false;  // velocities are found again, for this segment
    s.material_clock = s.material_clock.from(first_step, s.segment.time_step);
    s.run_clock = s.run_clock.from(first_step, s.segment.time_step);
    for (FixSurface* surface : s.surfaces) surface->follow(s.run_clock);
    if (s.planes == nullptr) return;
    FixPlanes::Motion motion = s.planes->motion();
    motion.segment = segment;
    motion.first_step = first_step;
    s.planes->move(motion);
    if (s.sides != nullptr) s.sides->follow(segment, first_step, step());
}

void Simulation::run(std::int64_t steps, const Watch& watch) {
    State& s = *state_;
    s.set_up_if_needed();
    // While the sample comes to rest between planes that stand still, the sides do too.
    if (s.loading && s.sides != nullptr && s.model.lateral == Lateral::periodic && !s.quasi_static() && steps > 0)
        s.steer_sides();
    // Forces accelerate on the way; velocities are found at its end.
    if (!s.relaxing) s.harden(s.material_clock.at(step() + (s.quasi_static() ? steps : steps / 2)));
    s.watch->call(watch);
    constexpr std::int64_t most = 1'000'000'000;  // LIGGGHTS counts the steps of one run in an int
    for (std::int64_t left = steps; left > 0; left -= most)
        s.session.command(fmt::format("run {} pre no post no", std::min(left, most)));
    s.watch->call({});
}

void Simulation::run_to_stress_sample(std::int64_t steps, const Watch& watch) {
    if (state_->planes != nullptr) state_->planes->tally_at(step() + steps);
    for (FixSurface* surface : state_->surfaces) surface->tally_at(step() + steps);
    run(steps, watch);
}

std::int64_t Simulation::step() const {
    return state_->session.lmp().update->ntimestep;
}

double Simulation::strain() const {
    return state_->segment.strain_at(state_->time_in_segment());
}

void Simulation::advise(const std::string& text) {
    Session::advise(text);
}

}  // namespace tomodem::plugin
