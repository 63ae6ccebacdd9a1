#include "solver_plugin/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "solver_plugin/crown_pair.hpp"
#include "solver_plugin/fix_contact.hpp"
#include "solver_plugin/planes.hpp"
#include "solver_plugin/session.hpp"

namespace tomodem::plugin {
namespace {

/// Neighbour skin over the seed radius. BILIN's packings are cold, TRILIN's hot; the vector kernel prunes the list
/// anyway.
double skin_over_seed(const Model& model) {
    return model.trilin ? 1.6 : 0.6;
}

/// Radius over the mean of particle `id`: a normal distribution cut at three standard deviations, the same everywhere.
double radius_factor(std::int64_t id, double dispersion) {
    if (dispersion == 0) return 1;
    std::mt19937_64 random(static_cast<std::uint64_t>(id) * 0x9E3779B97F4A7C15ULL);
    std::normal_distribution<double> normal;
    double deviate = normal(random);
    while (std::abs(deviate) > 3) deviate = normal(random);
    return 1 + dispersion * deviate;
}

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
    CrownPair* pair = nullptr;
    FixContact* contact = nullptr;
    std::vector<std::int32_t> object;  ///< by id - 1, where the law looks at it
    std::vector<double> hardening;     ///< factor of each phase at present
    std::int64_t loading_start = 0;    ///< step
    bool ready = false;                ///< LIGGGHTS is set up for the present masses and planes

    State(const Packing& sample, const Model& model, int axis, MPI_Comm communicator)
        : communicator(communicator), model(model), axis(axis), session(communicator) {
        MPI_Comm_rank(communicator, &rank);
        scale = model.seed_radius / sample.seed_radius;
        count = static_cast<std::int64_t>(sample.size());
        if (model.between_objects) object = sample.object;
        hardening.assign(model.phases.size(), 1.0);
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

    /// Laws of all pairs of types with the present strength of each phase.
    void use_laws() {
        PairLaws laws;
        laws.type_count = static_cast<int>(model.phases.size());
        laws.dispersed = model.radius_dispersion > 0;
        laws.seed_to_crown = model.seed_radius / model.crown_radius;
        std::vector<law::Pair> own;
        for (std::size_t k = 0; k < model.phases.size(); ++k)
            own.push_back(law::scaled(model.phases[k].pair, hardening[k]));
        for (const law::Pair& a : own)
            for (const law::Pair& b : own) laws.of_types.push_back(law::mixed(a, b));
        pair->use(laws);
        if (planes == nullptr) return;
        std::vector<law::Wall> walls(1);  // types count from 1
        for (const law::Pair& law : own) walls.push_back(law::against_wall(law));
        planes->use(std::move(walls));
    }

    /// A phase that hardens keeps its natural period: stiffness and mass grow together, so that no trajectory changes.
    void harden(double time) {
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

    void remember_contacts() {
        session.command("fix contact all tomodem/contact");
        contact = static_cast<FixContact*>(session.lmp().modify->find_fix_id("contact"));
        contact->memory().set_law({.least_outward = law::SelfContact::outward_over_seed * model.seed_radius});
        if (std::isfinite(model.healing_time)) contact->heal_after(std::llround(model.healing_time / model.time_step));
    }

    void create_particles(const Packing& sample) {
        LAMMPS_NS::Atom& atoms = atom();
        const LAMMPS_NS::Domain& domain = *session.lmp().domain;
        for (std::size_t k = 0; k < sample.size(); ++k) {
            Vec3 point = to_solver(sample.position[k]);
            bool mine = true;
            for (int c = 0; c < 3; ++c) mine = mine && point[c] >= domain.sublo[c] && point[c] < domain.subhi[c];
            if (!mine) continue;
            const int type = type_of(sample.species[k]);
            atoms.avec->create_atom(type, point.data());
            const int i = atoms.nlocal - 1;
            atoms.tag[i] = static_cast<int>(k) + 1;
            atoms.radius[i] = model.crown_radius * radius_factor(sample.id[k], model.radius_dispersion);
        }
        atoms.natoms = static_cast<LAMMPS_NS::bigint>(std::llround(total(atoms.nlocal)));
        if (atoms.natoms != count)
            throw InvalidInput(
                fmt::format("only {} of {} particles could be placed in the solver", atoms.natoms, count));
        atoms.map_init();
        atoms.map_set();
    }

    /// The height that `wanted` centres lie beyond: below it for inward = 1, above it for -1.
    double face(double low, double high, double wanted, double inward) {
        double outside = inward > 0 ? low : high, inside = inward > 0 ? high : low;
        while (std::abs(inside - outside) > 1e-9 * model.seed_radius) {
            const double middle = (inside + outside) / 2;
            double beyond = 0;
            for (int i = 0; i < atom().nlocal; ++i) beyond += inward * (atom().x[i][2] - middle) <= 0;
            (total(beyond) < wanted ? outside : inside) = middle;
        }
        return inside;
    }

    template <class PeriodOf>
    void set_masses(PeriodOf period_of) {
        LAMMPS_NS::Atom& atoms = atom();
        const double crown_volume = 4.0 / 3.0 * std::numbers::pi * std::pow(model.crown_radius, 3);
        for (int i = 0; i < atoms.nlocal; ++i) {
            const PhaseModel& phase = model.phases[atoms.type[i] - 1];
            const double stiffness = phase.pair.repulsive_stiffness * hardening[atoms.type[i] - 1];
            atoms.rmass[i] = law::mass_for_period(stiffness, period_of(phase));
            atoms.density[i] = atoms.rmass[i] / crown_volume;
        }
        ready = false;
    }

    void set_up() {
        if (!ready) session.command("run 0 post no");
        ready = true;
    }

    /// The items of every process one after the other, on the first process.
    template <class Item>
    std::vector<Item> gather_all(const std::vector<Item>& mine) const {
        int processes = 1;
        MPI_Comm_size(communicator, &processes);
        MPI_Datatype item;
        MPI_Type_contiguous(sizeof(Item), MPI_BYTE, &item);
        MPI_Type_commit(&item);
        const int count = static_cast<int>(mine.size());
        std::vector<int> counts(processes), starts(processes + 1);
        MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, communicator);
        for (int p = 0; p < processes; ++p) starts[p + 1] = starts[p] + counts[p];
        std::vector<Item> all(rank == 0 ? starts.back() : 0);
        MPI_Gatherv(mine.data(), count, item, all.data(), counts.data(), starts.data(), item, 0, communicator);
        MPI_Type_free(&item);
        return all;
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
    const double largest_factor = 1 + 3 * model.radius_dispersion;
    // How far the box may shrink: its neighbour bins must hold a crown and a skin even where the sample is flat.
    const double least = 2 * model.crown_radius * largest_factor + skin_over_seed(model) * model.seed_radius;
    LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    domain.minxlo = domain.minylo = domain.minzlo = -least;
    domain.minxhi = domain.minyhi = domain.minzhi = least;
    s.set_masses([](const PhaseModel& phase) { return phase.natural_period; });

    command(fmt::format("neighbor {:.17g} bin", skin_over_seed(model) * model.seed_radius));
    command("neigh_modify delay 0 every 1 check yes");
    // Asked for by LIGGGHTS, read by no law of ours.
    std::string young = "peratomtype", poisson = "peratomtype";
    for (std::size_t k = 0; k < model.phases.size(); ++k) {
        young += " 5e6";
        poisson += " 0.3";
    }
    command("fix youngsModulus all property/global youngsModulus " + young);
    command("fix poissonsRatio all property/global poissonsRatio " + poisson);
    command(fmt::format("pair_style gran model {} tangential off", model.trilin ? "trilin" : "bilin"));
    s.pair = CrownPair::of(s.session.lmp());
    s.use_laws();
    if (!s.object.empty()) s.pair->tell_objects_apart(s.object.data());
    command("pair_coeff * *");
    command(fmt::format("timestep {:.17g}", model.time_step));
    command("fix integration all tomodem/integrate");
    command("thermo_style custom step atoms");
    command("thermo_modify lost ignore norm no");
    command("thermo 0");
}

Simulation::~Simulation() = default;

void Simulation::begin_relaxation() {
    State& s = *state_;
    // On the stiffness of its stiffest pair, or light soft particles fly out from between stiff ones.
    const auto period_of = [&](const PhaseModel& phase) {
        double stiffest = phase.pair.repulsive_stiffness;
        for (const PhaseModel& other : s.model.phases)
            stiffest = std::max(stiffest, law::mixed(phase.pair, other.pair).repulsive_stiffness);
        const double period = law::least_steps_per_period * s.model.time_step;
        return period * std::sqrt(stiffest / phase.pair.repulsive_stiffness);
    };
    s.set_masses(period_of);
    // Viscous drag of a share of the critical one, 2 sqrt(k_rep m) = k_rep period / pi.
    const auto drag = [&](const PhaseModel& phase) {
        return relaxation_damping * phase.pair.repulsive_stiffness * period_of(phase) / std::numbers::pi;
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
    if (s.model.trilin) {
        const double layer = std::min(s.model.crown_radius - s.model.seed_radius, high - low);
        const double in_layer = static_cast<double>(s.count) * layer / (high - low);
        low = s.face(low, high, in_layer, 1) - layer;
        high = s.face(low, high, in_layer, -1) + layer;
    }
    if (s.planes == nullptr) {
        s.session.command("fix planes all tomodem/planes");
        s.planes = static_cast<FixPlanes*>(s.session.lmp().modify->find_fix_id("planes"));
    }
    // Pairs that form before, while the free sample comes to rest, are internal.
    if (s.model.self_contact && s.contact == nullptr) s.remember_contacts();
    FixPlanes::Motion motion;
    motion.centre = (low + high) / 2;
    motion.initial_height = high - low;
    motion.seed_radius = s.model.seed_radius;
    motion.first_step = s.loading_start = step();
    s.planes->move(motion);
    s.use_laws();
    s.ready = false;
}

void Simulation::set_loading(double strain, double rate) {
    FixPlanes::Motion motion = state_->planes->motion();
    motion.strain = strain;
    motion.rate = rate;
    motion.first_step = step();
    state_->planes->move(motion);
}

void Simulation::run(std::int64_t steps) {
    State& s = *state_;
    s.set_up();
    if (s.planes != nullptr) s.harden(static_cast<double>(step() + steps / 2 - s.loading_start) * s.model.time_step);
    s.session.command(fmt::format("run {} pre no post no", steps));
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
    return {s.total(kinetic) * to_sample, s.total(s.pair->seed_energy()) * to_sample};
}

double Simulation::hottest_phase() const {
    const State& s = *state_;
    const LAMMPS_NS::Atom& atoms = state_->atom();
    std::vector<double> kinetic(s.model.phases.size(), 0.0), count(kinetic);
    for (int i = 0; i < atoms.nlocal; ++i) {
        const int phase = atoms.type[i] - 1;
        count[phase] += 1;
        for (int c = 0; c < 3; ++c) kinetic[phase] += 0.5 * atoms.rmass[i] * atoms.v[i][c] * atoms.v[i][c];
    }
    double hottest = 0;
    for (std::size_t k = 0; k < kinetic.size(); ++k) {
        const double stiffness = s.model.phases[k].pair.repulsive_stiffness * s.hardening[k];
        const double scale = s.total(count[k]) * stiffness * s.model.seed_radius * s.model.seed_radius;
        const double energy = s.total(kinetic[k]);
        if (scale > 0) hottest = std::max(hottest, energy / scale);
    }
    return hottest;
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

std::int64_t Simulation::neighbour_builds() const {
    return state_->session.lmp().neighbor->ncalls;
}

std::vector<Vec3> Simulation::positions() const {
    State& s = *state_;
    std::vector<Vec3> points = s.gather(s.atom().x);
    for (Vec3& point : points) point = s.centre + s.turned_back(point) / s.scale;
    return points;
}

std::vector<Contact> Simulation::contacts() const {
    State& s = *state_;
    s.set_up();
    const LAMMPS_NS::Atom& atoms = s.atom();
    std::vector<Contact> mine;
    s.pair->for_each_pair([&](int i, int j) {
        const std::int64_t a = atoms.tag[i], b = atoms.tag[j];
        // A pair across a process boundary is seen from both sides.
        if (j >= atoms.nlocal && a >= b) return;
        double squared = 0;
        for (int c = 0; c < 3; ++c) squared += (atoms.x[i][c] - atoms.x[j][c]) * (atoms.x[i][c] - atoms.x[j][c]);
        const double crowns = atoms.radius[i] + atoms.radius[j];
        if (squared > crowns * crowns) return;
        Contact contact{std::min(a, b), std::max(a, b), ContactState::internal, 0};
        if (!s.object.empty() && s.object[a - 1] != s.object[b - 1])
            contact.state = ContactState::between_objects;
        else if (s.contact != nullptr)
            for (const ContactMemory::Interface& known : s.contact->memory().interfaces(i))
                if (known.partner == b) {
                    contact.state = ContactState::interface;
                    contact.age = step() - known.since;
                }
        mine.push_back(contact);
    });
    std::vector<Contact> all = s.gather_all(mine);
    std::sort(all.begin(), all.end());
    return all;
}

std::vector<Vec3> Simulation::outward_vectors() const {
    State& s = *state_;
    s.set_up();
    std::vector<Vec3> mine(s.atom().nlocal, Vec3::Zero());
    std::vector<double*> rows;
    for (std::size_t i = 0; i < mine.size(); ++i) {
        if (s.contact != nullptr) {
            const ContactMemory::Outward& outward = s.contact->memory().outward()[i];
            mine[i] = s.turned_back({outward[0], outward[1], outward[2]}) / s.scale;
        }
        rows.push_back(mine[i].data());
    }
    return s.gather(rows.data());
}

std::vector<int> Simulation::owners() const {
    State& s = *state_;
    struct Owner {
        int tag, rank;
    };
    std::vector<Owner> mine;
    for (int i = 0; i < s.atom().nlocal; ++i) mine.push_back({s.atom().tag[i], s.rank});
    std::vector<int> owners(s.rank == 0 ? s.count : 0);
    for (const Owner& owner : s.gather_all(mine)) owners[owner.tag - 1] = owner.rank;
    return owners;
}

std::array<int, 3> Simulation::process_grid() const {
    const int* const grid = state_->session.lmp().comm->procgrid;
    return {grid[0], grid[1], grid[2]};
}

std::vector<Vec3> Simulation::forces_at(const std::vector<Vec3>& velocities) {
    State& s = *state_;
    LAMMPS_NS::Atom& atoms = s.atom();
    for (int i = 0; i < atoms.nlocal; ++i)
        for (int c = 0; c < 3; ++c) atoms.v[i][c] = s.scale * velocities[atoms.tag[i] - 1][s.turned(c)];
    s.session.command("run 0 post no");
    s.ready = true;
    std::vector<Vec3> forces = s.gather(atoms.f);
    for (Vec3& force : forces) force = s.turned_back(force) / (s.scale * s.scale);
    return forces;
}

}  // namespace tomodem::plugin
