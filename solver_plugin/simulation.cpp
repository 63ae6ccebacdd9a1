#include "solver_plugin/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "solver_plugin/bilin_pair.hpp"
#include "solver_plugin/planes.hpp"
#include "solver_plugin/session.hpp"

namespace tomodem::plugin {
namespace {

/// Neighbour skin over the seed radius: BILIN's packings are cold, and the vector kernel prunes the list anyway.
constexpr double skin_over_seed = 0.6;

/// Drag during relaxation over the critical one. Without it the chatter of the attraction keeps the sample warm, and
/// its surface tension closes pores: a foam's struts then move by 20 seed radii instead of 2.
constexpr double relaxation_damping = 0.3;

}  // namespace

struct Simulation::State {
    MPI_Comm communicator;
    int rank = 0;
    Model model;
    int axis;
    double scale = 1;  ///< solver's length over the sample's
    Vec3 centre;       ///< of the sample, in its own lengths
    std::int64_t count = 0;
    Session session;
    FixPlanes* planes = nullptr;
    bool ready = false;              ///< LIGGGHTS is set up for the present masses and planes
    double sample_volume = 0;        ///< of the sample's box, in its own lengths
    std::int64_t builds_before = 0;  ///< neighbour builds before the last set-up

    State(const Packing& sample, const Model& model, int axis, MPI_Comm communicator)
        : communicator(communicator), model(model), axis(axis), session(communicator) {
        MPI_Comm_rank(communicator, &rank);
        scale = model.seed_radius / sample.seed_radius;
        count = static_cast<std::int64_t>(sample.size());
        sample_volume = sample.box.volume();
    }

    LAMMPS_NS::Atom& atom() { return *session.lmp().atom; }

    /// Component of the sample's coordinates that the solver calls `component`: the loading axis becomes z.
    int turned(int component) const { return (component + axis + 1) % 3; }

    Vec3 to_solver(const Vec3& point) const {
        const Vec3 local = scale * (point - centre);
        return {local[turned(0)], local[turned(1)], local[turned(2)]};
    }

    /// Turns a vector of the solver back to the sample's axes, without scaling.
    Vec3 turned_back(const Vec3& vector) const {
        Vec3 result;
        for (int component = 0; component < 3; ++component) result[turned(component)] = vector[component];
        return result;
    }

    double total(double mine) const {
        double sum = 0;
        MPI_Allreduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, communicator);
        return sum;
    }

    double largest(double mine) const {
        double highest = 0;
        MPI_Allreduce(&mine, &highest, 1, MPI_DOUBLE, MPI_MAX, communicator);
        return highest;
    }

    int type_of(std::int32_t label) const {
        for (std::size_t k = 0; k < model.phases.size(); ++k)
            if (model.phases[k].label == label) return static_cast<int>(k) + 1;
        throw InvalidInput(fmt::format("the model has no phase with label {}", label));
    }

    void add_planes() {
        if (planes != nullptr) return;
        session.command("fix planes all tomodem/planes");
        planes = static_cast<FixPlanes*>(session.lmp().modify->find_fix_id("planes"));
    }

    /// One matrix of a pair constant, as `fix property/global` takes it.
    template <class Constant>
    std::string pair_matrix(Constant constant) const {
        std::string words = std::to_string(model.phases.size());
        for (const PhaseModel& a : model.phases)
            for (const PhaseModel& b : model.phases) words += fmt::format(" {:.17g}", constant(mixed(a.pair, b.pair)));
        return words;
    }

    void create_particles(const Packing& sample) {
        const LAMMPS_NS::Domain& domain = *session.lmp().domain;
        for (std::size_t k = 0; k < sample.size(); ++k) {
            Vec3 point = to_solver(sample.position[k]);
            bool mine = true;
            for (int c = 0; c < 3; ++c) mine = mine && point[c] >= domain.sublo[c] && point[c] < domain.subhi[c];
            if (!mine) continue;
            create_particle(type_of(sample.species[k]), static_cast<int>(k) + 1, point.data());
        }
        count_particles();
    }

    void create_particle(int type, int tag, double* point) {
        LAMMPS_NS::Atom& atoms = atom();
        atoms.avec->create_atom(type, point);
        const int i = atoms.nlocal - 1;
        atoms.tag[i] = tag;
        atoms.radius[i] = model.crown_radius;
    }

    void count_particles() {
        LAMMPS_NS::Atom& atoms = atom();
        atoms.natoms = static_cast<LAMMPS_NS::bigint>(std::llround(total(atoms.nlocal)));
        if (atoms.natoms != count)
            throw InvalidInput(
                fmt::format("only {} of {} particles could be placed in the solver", atoms.natoms, count));
        atoms.map_init();
        atoms.map_set();
    }

    template <class PeriodOf>
    void set_masses(PeriodOf period_of) {
        LAMMPS_NS::Atom& atoms = atom();
        const double crown_volume = 4.0 / 3.0 * std::numbers::pi * std::pow(model.crown_radius, 3);
        for (int i = 0; i < atoms.nlocal; ++i) {
            const PhaseModel& phase = model.phases[atoms.type[i] - 1];
            atoms.rmass[i] = law::mass_for_period(phase.pair.repulsive_stiffness, period_of(phase));
            atoms.density[i] = atoms.rmass[i] / crown_volume;
        }
        ready = false;
    }

    void set_up_if_needed() {
        if (ready) return;
        builds_before += session.lmp().neighbor->ncalls;
        session.command("run 0 post no");
        ready = true;
    }

    /// Deals `components` values of each local particle out to the processes that hold their rows.
    RowBlock rows(int components, const std::vector<double>& local) {
        LAMMPS_NS::Atom& atoms = atom();
        int processes = 1;
        MPI_Comm_size(communicator, &processes);
        std::vector<std::size_t> first(processes + 1);
        for (int p = 0; p <= processes; ++p) first[p] = first_row(count, p, processes);
        const auto owner = [&](int tag) {
            const auto row = static_cast<std::size_t>(tag - 1);
            return static_cast<int>(std::upper_bound(first.begin(), first.end(), row) - first.begin()) - 1;
        };
        const int width = components + 1;  // with the tag, which a double holds exactly
        std::vector<int> sizes(processes, 0), received(processes), from(processes, 0), to(processes, 0);
        for (int i = 0; i < atoms.nlocal; ++i) sizes[owner(atoms.tag[i])] += width;
        MPI_Alltoall(sizes.data(), 1, MPI_INT, received.data(), 1, MPI_INT, communicator);
        for (int p = 1; p < processes; ++p) {
            from[p] = from[p - 1] + sizes[p - 1];
            to[p] = to[p - 1] + received[p - 1];
        }
        std::vector<double> out(static_cast<std::size_t>(width) * atoms.nlocal);
        std::vector<double> in(static_cast<std::size_t>(to.back()) + received.back());
        std::vector<int> next = from;
        for (int i = 0; i < atoms.nlocal; ++i) {
            double* const record = out.data() + next[owner(atoms.tag[i])];
            next[owner(atoms.tag[i])] += width;
            record[0] = atoms.tag[i];
            std::copy_n(local.data() + static_cast<std::size_t>(components) * i, components, record + 1);
        }
        MPI_Alltoallv(out.data(), sizes.data(), from.data(), MPI_DOUBLE, in.data(), received.data(), to.data(),
                      MPI_DOUBLE, communicator);
        RowBlock block{first[rank], components, {}};
        block.values.resize((first[rank + 1] - first[rank]) * components);
        for (std::size_t k = 0; k < in.size(); k += width) {
            const std::size_t row = static_cast<std::size_t>(in[k]) - 1 - first[rank];
            std::copy_n(in.data() + k + 1, components, block.values.data() + row * components);
        }
        return block;
    }

    /// Vectors of the local particles, in the order of the sample, on the first process.
    std::vector<Vec3> gather(double* const* local) {
        LAMMPS_NS::Atom& atoms = atom();
        int processes = 1;
        MPI_Comm_size(communicator, &processes);
        const int mine = atoms.nlocal;
        std::vector<int> counts(processes), starts(processes), triple_counts(processes), triple_starts(processes);
        MPI_Gather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, communicator);
        int all = 0;
        for (int p = 0; p < processes; ++p) {
            starts[p] = all;
            triple_counts[p] = 3 * counts[p];
            triple_starts[p] = 3 * all;
            all += counts[p];
        }
        std::vector<int> tags(rank == 0 ? all : 0);
        std::vector<double> values(rank == 0 ? 3 * static_cast<std::size_t>(all) : 0);
        MPI_Gatherv(atoms.tag, mine, MPI_INT, tags.data(), counts.data(), starts.data(), MPI_INT, 0, communicator);
        const double* first = mine > 0 ? local[0] : nullptr;
        MPI_Gatherv(first, 3 * mine, MPI_DOUBLE, values.data(), triple_counts.data(), triple_starts.data(), MPI_DOUBLE,
                    0, communicator);
        std::vector<Vec3> result(rank == 0 ? count : 0);
        for (std::size_t k = 0; k < tags.size(); ++k)
            result[tags[k] - 1] = Vec3(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
        return result;
    }
};

Simulation::Simulation(const Packing& sample, const Model& model, int axis, MPI_Comm communicator)
    : state_(std::make_unique<State>(sample, model, axis, communicator)) {
    State& s = *state_;
    if (sample.size() == 0) throw InvalidInput("the sample has no particle");
    Vec3 low = sample.position.front(), high = low;
    for (const Vec3& point : sample.position) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    s.centre = (low + high) / 2;
    const Vec3 extent = s.scale * (high - low);

    const auto command = [&](const std::string& line) { s.session.command(line); };
    command("atom_style granular");
    command("atom_modify map array");
    // Shrink-wrapped: nothing can leave the box, and it stays balanced over the processes while the sample spreads.
    command("boundary m m m");
    command("newton off");
    command("communicate single vel yes");
    command("units si");  // no conversion: any consistent set
    std::string corners;
    for (int c = 0; c < 3; ++c) {
        const double half = 0.5 * extent[s.turned(c)] + model.crown_radius;
        corners += fmt::format(" {:.17g} {:.17g}", -half, half);
    }
    command("region everywhere block" + corners + " units box");
    command(fmt::format("create_box {} everywhere", model.phases.size()));
    s.create_particles(sample);
    // How far the box may shrink: its neighbour bins must hold a crown and a skin even where the sample is flat.
    const double least = 2 * model.crown_radius + skin_over_seed * model.seed_radius;
    LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    domain.minxlo = domain.minylo = domain.minzlo = -least;
    domain.minxhi = domain.minyhi = domain.minzhi = least;
    s.set_masses([](const PhaseModel& phase) { return phase.natural_period; });

    command(fmt::format("neighbor {:.17g} bin", skin_over_seed * model.seed_radius));
    command("neigh_modify delay 0 every 1 check yes");
    const auto global = [&](const std::string& name, const std::string& words) {
        command(fmt::format("fix {0} all property/global {0} {1}", name, words));
    };
    global("repulsiveStiffness",
           "peratomtypepair " + s.pair_matrix([](const law::Bilin& pair) { return pair.repulsive_stiffness; }));
    global("attractiveStiffness",
           "peratomtypepair " + s.pair_matrix([](const law::Bilin& pair) { return pair.attractive_stiffness; }));
    global("seedToCrown", fmt::format("scalar {:.17g}", model.seed_radius / model.crown_radius));
    // Asked for by LIGGGHTS, read by no law of ours.
    std::string young = "peratomtype", poisson = "peratomtype";
    for (std::size_t k = 0; k < model.phases.size(); ++k) {
        young += " 5e6";
        poisson += " 0.3";
    }
    global("youngsModulus", young);
    global("poissonsRatio", poisson);
    command("pair_style gran model bilin tangential off");
    command("pair_coeff * *");
    command(fmt::format("timestep {:.17g}", model.time_step));
    command("fix integration all nve");
    command("thermo_style custom step atoms");
    command("thermo_modify lost ignore norm no");
    command("thermo 0");
}

Simulation::~Simulation() = default;

void Simulation::begin_relaxation() {
    State& s = *state_;
    const double period = law::least_steps_per_period * s.model.time_step;
    s.set_masses([period](const PhaseModel&) { return period; });
    // Viscous drag of a share of the critical one, 2 sqrt(k_rep m) = k_rep period / pi.
    const auto drag = [&](const PhaseModel& phase) {
        return relaxation_damping * phase.pair.repulsive_stiffness * period / std::numbers::pi;
    };
    std::string words = fmt::format("fix drag all viscous {:.17g}", drag(s.model.phases.front()));
    for (std::size_t k = 1; k < s.model.phases.size(); ++k)
        words += fmt::format(" scale {} {:.17g}", k + 1, drag(s.model.phases[k]) / drag(s.model.phases.front()));
    s.session.command(words);
}

void Simulation::end_relaxation() {
    state_->session.command("unfix drag");
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
    FixPlanes::Motion motion;
    motion.centre = (low + high) / 2;
    motion.initial_height = high - low;
    motion.seed_radius = s.model.seed_radius;
    motion.first_step = step();
    s.add_planes();
    s.planes->move(motion);
    s.ready = false;
}

void Simulation::set_loading(double strain, double rate) {
    FixPlanes::Motion motion = state_->planes->motion();
    motion.strain = strain;
    motion.rate = rate;
    motion.first_step = step();
    state_->planes->move(motion);
}

void Simulation::run(std::int64_t steps, const Pace& pace) {
    State& s = *state_;
    s.set_up_if_needed();
    constexpr std::int64_t most = 1'000'000'000;  // LIGGGHTS counts the steps of one run in an int
    for (std::int64_t left = steps; left > 0;) {
        const std::int64_t piece = std::min(left, pace ? std::max<std::int64_t>(1, pace()) : most);
        s.session.command(fmt::format("run {} pre no post no", piece));
        left -= piece;
    }
}

void Simulation::run_to_stress_sample(std::int64_t steps, const Pace& pace) {
    sample_stress_at(step() + steps);
    run(steps, pace);
}

std::int64_t Simulation::step() const {
    return state_->session.lmp().update->ntimestep;
}

double Simulation::strain() const {
    return state_->planes->strain_at(step());
}

PlaneForces Simulation::take_forces() {
    const FixPlanes::Forces mine = state_->planes->take_forces();
    PlaneForces forces;
    forces.steps = mine.steps;
    // Stress is the same in both lengths: forces scale with the section.
    const double per_step = 1 / (std::max(1L, mine.steps) * state_->scale * state_->scale);
    forces.top = state_->total(mine.top) * per_step;
    forces.bottom = state_->total(mine.bottom) * per_step;
    return forces;
}

Energies Simulation::energies() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    double kinetic = 0;
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) kinetic += 0.5 * atoms.rmass[i] * atoms.v[i][c] * atoms.v[i][c];
    const double to_sample = 1 / std::pow(s.scale, 3);
    return {s.total(kinetic) * to_sample, s.total(seed_energy(&s.session.lmp())) * to_sample};
}

double Simulation::largest_speed() const {
    const LAMMPS_NS::Atom& atoms = state_->atom();
    double squared = 0;
    for (int i = 0; i < atoms.nlocal; ++i)
        squared = std::max(
            squared, atoms.v[i][0] * atoms.v[i][0] + atoms.v[i][1] * atoms.v[i][1] + atoms.v[i][2] * atoms.v[i][2]);
    return std::sqrt(state_->largest(squared)) / state_->scale;
}

double Simulation::initial_height() const {
    return state_->planes->motion().initial_height / state_->scale;
}

std::int64_t Simulation::particles() const {
    return std::llround(state_->total(state_->atom().nlocal));
}

std::int64_t Simulation::particles_behind_planes() const {
    const State& s = *state_;
    if (s.planes == nullptr) return 0;
    const double half_gap = s.planes->half_gap_at(step()), centre = s.planes->motion().centre;
    const LAMMPS_NS::Atom& atoms = state_->atom();
    double behind = 0;
    for (int i = 0; i < atoms.nlocal; ++i) behind += std::abs(atoms.x[i][2] - centre) > half_gap;
    return std::llround(state_->total(behind));
}

std::int64_t Simulation::neighbour_builds() const {
    return state_->builds_before + state_->session.lmp().neighbor->ncalls;
}

void Simulation::advise(const std::string& text) {
    Session::advise(text);
}

void Simulation::save(Checkpoint& checkpoint) const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    const LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    const auto mine = static_cast<std::size_t>(atoms.nlocal);
    ParticleState& particles = checkpoint.particles;
    particles.tag.assign(atoms.tag, atoms.tag + mine);
    particles.type.assign(atoms.type, atoms.type + mine);
    particles.position.assign(mine > 0 ? atoms.x[0] : nullptr, mine > 0 ? atoms.x[0] + 3 * mine : nullptr);
    particles.velocity.assign(mine > 0 ? atoms.v[0] : nullptr, mine > 0 ? atoms.v[0] + 3 * mine : nullptr);
    particles.memory_length.assign(mine, 0);
    particles.memory.clear();
    checkpoint.numbers["solver_step"] = {static_cast<double>(step())};
    checkpoint.numbers["solver_box"] = {domain.boxlo[0], domain.boxlo[1], domain.boxlo[2],
                                        domain.boxhi[0], domain.boxhi[1], domain.boxhi[2]};
    if (s.planes != nullptr)
        checkpoint.numbers["solver_planes"] = {s.planes->motion().centre, s.planes->motion().initial_height};
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
    }
    s.count_particles();
    s.set_masses([](const PhaseModel& phase) { return phase.natural_period; });
    const std::vector<double>& box = found.checkpoint.numbers.at("solver_box");
    std::copy_n(box.data(), 3, domain.boxlo);
    std::copy_n(box.data() + 3, 3, domain.boxhi);
    domain.set_global_box();
    domain.set_local_box();
    if (!found.same_processes) LAMMPS_NS::Irregular(&s.session.lmp()).migrate_atoms();
    set_step(static_cast<std::int64_t>(found.checkpoint.number("solver_step")));
    if (const auto planes = found.checkpoint.numbers.find("solver_planes"); planes != found.checkpoint.numbers.end()) {
        s.add_planes();
        FixPlanes::Motion motion;
        motion.centre = planes->second.at(0);
        motion.initial_height = planes->second.at(1);
        motion.seed_radius = s.model.seed_radius;
        motion.first_step = step();
        s.planes->move(motion);
    }
    s.ready = false;
}

void Simulation::rest() {
    state_->ready = false;
}

void Simulation::set_step(std::int64_t step) {
    state_->session.command(fmt::format("reset_timestep {}", step));
}

RowBlock Simulation::position_rows() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    std::vector<double> values;
    values.reserve(3 * static_cast<std::size_t>(atoms.nlocal));
    for (int i = 0; i < atoms.nlocal; ++i) {
        const Vec3 point = s.centre + s.turned_back(Vec3(atoms.x[i])) / s.scale;
        values.insert(values.end(), point.begin(), point.end());
    }
    return s.rows(3, values);
}

RowBlock Simulation::velocity_rows() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    std::vector<double> values;
    values.reserve(3 * static_cast<std::size_t>(atoms.nlocal));
    for (int i = 0; i < atoms.nlocal; ++i) {
        const Vec3 velocity = s.turned_back(Vec3(atoms.v[i])) / s.scale;
        values.insert(values.end(), velocity.begin(), velocity.end());
    }
    return s.rows(3, values);
}

double Simulation::volume_per_particle() const {
    return state_->sample_volume / static_cast<double>(state_->count);
}

void Simulation::prepare_stress_samples() {
    // Its part is to ask for the virial of each particle in the steps that are sampled.
    state_->session.command("compute stress all stress/atom pair");
    state_->ready = false;
}

void Simulation::sample_stress_at(std::int64_t step) {
    State& s = *state_;
    LAMMPS_NS::Modify& modify = *s.session.lmp().modify;
    modify.compute[modify.find_compute("stress")]->addstep(step);
    if (s.planes != nullptr) s.planes->tally_at(step);
}

RowBlock Simulation::stress_rows() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    const LAMMPS_NS::Pair& pair = *s.session.lmp().force->pair;
    if (pair.vatom == nullptr && atoms.nlocal > 0) throw std::logic_error("no stress was sampled");
    // The virial sums f_a d_b with d from the neighbour: the lever from the centre to the contact is -d/2.
    const double over_volume = 1 / (volume_per_particle() * std::pow(s.scale, 3));
    constexpr int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2};
    std::vector<double> values(6 * static_cast<std::size_t>(atoms.nlocal));
    for (int i = 0; i < atoms.nlocal; ++i) {
        double solver[3][3], turned[3][3];
        for (int k = 0; k < 6; ++k) {
            const double virial = -pair.vatom[i][k] + (k == 2 && s.planes != nullptr ? s.planes->tallied(i) : 0.0);
            solver[first[k]][second[k]] = solver[second[k]][first[k]] = virial * over_volume;
        }
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) turned[s.turned(a)][s.turned(b)] = solver[a][b];
        for (int k = 0; k < 6; ++k) values[6 * static_cast<std::size_t>(i) + k] = turned[first[k]][second[k]];
    }
    return s.rows(6, values);
}

std::vector<Vec3> Simulation::positions() const {
    State& s = *state_;
    std::vector<Vec3> points = s.gather(s.atom().x);
    for (Vec3& point : points) point = s.centre + s.turned_back(point) / s.scale;
    return points;
}

std::vector<Vec3> Simulation::forces_at(const std::vector<Vec3>& velocities) {
    State& s = *state_;
    LAMMPS_NS::Atom& atoms = s.atom();
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) atoms.v[i][c] = s.scale * velocities[atoms.tag[i] - 1][s.turned(c)];
    s.ready = false;
    s.set_up_if_needed();
    std::vector<Vec3> forces = s.gather(atoms.f);
    for (Vec3& force : forces) force = s.turned_back(force) / (s.scale * s.scale);
    return forces;
}

}  // namespace tomodem::plugin
