#include "solver_plugin/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "core/error.hpp"
#include "core/law/bilin_flow.hpp"
#include "solver_plugin/crown_pair.hpp"
#include "solver_plugin/fix_contact.hpp"
#include "solver_plugin/fix_watch.hpp"
#include "solver_plugin/lateral_box.hpp"
#include "solver_plugin/planes.hpp"
#include "solver_plugin/session.hpp"
#include "solver_plugin/surfaces.hpp"

namespace tomodem::plugin {
namespace {

/// Skin of LIGGGHTS' ghosts over the seed radius: BILIN's packings are cold, TRILIN's hot. The vector loop has a list
/// of its own.
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

/// Growth of the periodic sides per unit of strain over the lateral pressure in units of k_rep / 2 r_s: the mean stress
/// across the load dies out over about 0.005 of strain.
constexpr double side_gain = 500;

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
    FixLateralBox* sides = nullptr;  ///< when they are periodic
    std::vector<FixSurface*> surfaces;
    LoadSegment segment;             ///< the present one
    std::int64_t segment_start = 0;  ///< its first step
    CrownPair* pair = nullptr;
    FixWatch* watch = nullptr;
    FixContact* contact = nullptr;
    std::vector<std::int32_t> object;  ///< by id - 1, where the law looks at it
    std::vector<double> hardening;     ///< factor of each phase at present
    bool relaxing = false;
    bool loading = false;
    std::int64_t loading_start = 0;      ///< step
    bool ready = false;                  ///< LIGGGHTS is set up for the present masses, planes and walls
    double sample_volume = 0;            ///< of the sample's box, in its own lengths
    std::int64_t builds_before = 0;      ///< neighbour builds before the last set-up
    bool counting = false;               ///< there was a set-up
    std::vector<double> radius_factors;  ///< by row; empty: all 1

    State(const Packing& sample, const Model& model, int axis, MPI_Comm communicator)
        : communicator(communicator), model(model), axis(axis), session(communicator) {
        MPI_Comm_rank(communicator, &rank);
        scale = model.seed_radius / sample.seed_radius;
        count = static_cast<std::int64_t>(sample.size());
        sample_volume = sample.box.volume();
        if (model.between_objects) object = sample.object;
        for (const PhaseModel& phase : model.phases)
            hardening.push_back(phase.hardening ? phase.hardening->factor(0) : 1.0);
        if (model.radius_dispersion > 0)
            for (const std::int64_t id : sample.id)
                radius_factors.push_back(radius_factor(id, model.radius_dispersion));
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

    void add_sides() {
        session.command("fix sides all tomodem/lateral");
        sides = static_cast<FixLateralBox*>(session.lmp().modify->find_fix_id("sides"));
    }

    void add_planes() {
        if (planes != nullptr) return;
        session.command("fix planes all tomodem/planes");
        planes = static_cast<FixPlanes*>(session.lmp().modify->find_fix_id("planes"));
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
        std::vector<law::Wall> walls(1);  // types count from 1
        for (const law::Pair& law : own) walls.push_back(law::against_wall(law));
        if (planes != nullptr) planes->use(walls);
        for (FixSurface* surface : surfaces) surface->use(walls);
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
        ready = false;  // the pair style finds it when it is set up
        contact = static_cast<FixContact*>(session.lmp().modify->find_fix_id("contact"));
        contact->memory().set_law({.least_outward = law::SelfContact::outward_over_seed * model.seed_radius});
        if (std::isfinite(model.healing_time)) contact->heal_after(std::llround(model.healing_time / model.time_step));
    }

    /// Widens the periodic sides while the sample presses on them, and narrows them while it pulls.
    void steer_sides() {
        const LAMMPS_NS::Domain& domain = *session.lmp().domain;
        const FixPlanes::Motion& motion = planes->motion();
        const double time = model.time_step * static_cast<double>(session.lmp().update->ntimestep - segment_start);
        const double height = motion.initial_height * std::exp(segment.strain_at(time));
        const double pressure = total(pair->lateral_virial()) / (domain.xprd * domain.yprd * height);
        double stiffest = 0;
        for (const PhaseModel& phase : model.phases) stiffest = std::max(stiffest, phase.pair.repulsive_stiffness);
        const double reduced = pressure / (stiffest / (2 * model.seed_radius));
        sides->steer(std::clamp(side_gain * reduced, -1.0, 1.0));
    }

    /// Adds a random velocity of that standard deviation to every component; it depends on the particle alone.
    void shake(double deviation) {
        const LAMMPS_NS::Atom& atoms = atom();
        for (int i = 0; i < atoms.nlocal; ++i) {
            std::seed_seq seed{atoms.tag[i], 0x5eed};
            std::mt19937_64 random(seed);
            std::normal_distribution<double> normal(0, deviation);
            for (int c = 0; c < 3; ++c) atoms.v[i][c] += normal(random);
        }
    }

    void create_particles(const Packing& sample) {
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

    void create_particle(int type, int tag, double* point) {
        LAMMPS_NS::Atom& atoms = atom();
        atoms.avec->create_atom(type, point);
        const int i = atoms.nlocal - 1;
        atoms.tag[i] = tag;
        atoms.radius[i] = model.crown_radius * (radius_factors.empty() ? 1.0 : radius_factors[tag - 1]);
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

    /// LIGGGHTS counts from its last set-up on; before the first its number means nothing.
    std::int64_t builds() { return builds_before + (counting ? session.lmp().neighbor->ncalls : 0); }

    void set_up_if_needed() {
        if (ready) return;
        builds_before = builds();
        counting = true;
        session.command("run 0 post no");
        ready = true;
    }

    /// Deals `components` values of each local particle out to the processes that hold their rows, some particles at a
    /// time: a whole second copy would be the highest peak of memory.
    /// @param value  (local particle, component)
    template <class Value>
    RowBlock rows(int components, Value value) {
        constexpr int share = 1 << 16;  // particles of a process at a time
        const LAMMPS_NS::Atom& atoms = atom();
        int processes = 1;
        MPI_Comm_size(communicator, &processes);
        std::vector<std::size_t> first(processes + 1);
        for (int p = 0; p <= processes; ++p) first[p] = first_row(count, p, processes);
        const auto owner = [&](int tag) {
            const auto row = static_cast<std::size_t>(tag - 1);
            return static_cast<int>(std::upper_bound(first.begin(), first.end(), row) - first.begin()) - 1;
        };
        RowBlock block{first[rank], components, {}};
        block.values.resize((first[rank + 1] - first[rank]) * components);
        const int width = components + 1;  // with the tag, which a double holds exactly
        const auto shares = static_cast<int>(std::ceil(largest(atoms.nlocal) / share));
        std::vector<double> out, in;
        std::vector<int> received(processes), from(processes + 1, 0), to(processes + 1, 0);
        for (int number = 0; number < shares; ++number) {
            const int begin = std::min(atoms.nlocal, number * share), end = std::min(atoms.nlocal, begin + share);
            std::vector<int> sizes(processes, 0);
            for (int i = begin; i < end; ++i) sizes[owner(atoms.tag[i])] += width;
            MPI_Alltoall(sizes.data(), 1, MPI_INT, received.data(), 1, MPI_INT, communicator);
            for (int p = 0; p < processes; ++p) {
                from[p + 1] = from[p] + sizes[p];
                to[p + 1] = to[p] + received[p];
            }
            out.resize(from.back());
            in.resize(to.back());
            std::vector<int> next = from;
            for (int i = begin; i < end; ++i) {
                int& at = next[owner(atoms.tag[i])];
                out[at] = atoms.tag[i];
                for (int component = 0; component < components; ++component)
                    out[at + 1 + component] = value(i, component);
                at += width;
            }
            MPI_Alltoallv(out.data(), sizes.data(), from.data(), MPI_DOUBLE, in.data(), received.data(), to.data(),
                          MPI_DOUBLE, communicator);
            for (std::size_t k = 0; k < in.size(); k += width) {
                const std::size_t row = static_cast<std::size_t>(in[k]) - 1 - first[rank];
                std::copy_n(in.data() + k + 1, components, block.values.data() + row * components);
            }
        }
        return block;
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
    const double largest_factor = 1 + 3 * model.radius_dispersion;
    // How far the box may shrink: its neighbour bins must hold a crown and a skin even where the sample is flat.
    const double least = 2 * model.crown_radius * largest_factor + skin_over_seed(model) * model.seed_radius;
    LAMMPS_NS::Domain& domain = *s.session.lmp().domain;
    domain.minxlo = domain.minylo = domain.minzlo = -least;
    domain.minxhi = domain.minyhi = domain.minzhi = least;
    s.set_masses([](const PhaseModel& phase) { return phase.natural_period; });

    command(fmt::format("neighbor {:.17g} bin", skin_over_seed(model) * model.seed_radius));
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
    const auto drag = [&](std::size_t k) {
        const double stiffness = s.model.phases[k].pair.repulsive_stiffness * s.hardening[k];
        return relaxation_damping * stiffness * period_of(s.model.phases[k]) / std::numbers::pi;
    };
    std::string words = fmt::format("fix drag all viscous {:.17g}", drag(0));
    for (std::size_t k = 1; k < s.model.phases.size(); ++k)
        words += fmt::format(" scale {} {:.17g}", k + 1, drag(k) / drag(0));
    s.session.command(words);
    s.relaxing = true;
}

void Simulation::end_relaxation() {
    state_->session.command("unfix drag");
    state_->relaxing = false;
    state_->loading_start = step();
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
    s.add_planes();
    FixPlanes::Motion motion;
    if (s.model.lateral != Lateral::free) {
        s.add_sides();
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
    if (s.loading) fix->start(s.loading_start);
    s.surfaces.push_back(fix);
    s.use_laws();
    s.ready = false;
    return std::llround(s.total(static_cast<double>(fix->particles_within(0.5 * s.model.seed_radius))));
}

void Simulation::set_loading(const LoadSegment& segment) {
    State& s = *state_;
    if (!s.loading) {
        // Walls stand still, and forces do not count, while the sample comes to rest between them.
        s.loading = true;
        s.loading_start = step();
        // Pairs that form before, while the sample comes to rest, are internal.
        if (s.model.self_contact) s.remember_contacts();
        for (FixSurface* surface : s.surfaces) surface->start(step());
        take_forces();
        take_wall_forces();
    }
    continue_loading(segment, step());
    if (s.planes != nullptr && segment.noise > 0) s.shake(segment.noise * 2 * s.model.seed_radius);
}

void Simulation::continue_loading(const LoadSegment& segment, std::int64_t first_step) {
    State& s = *state_;
    s.segment = segment;
    s.segment_start = first_step;
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
    if (s.loading && s.sides != nullptr && s.model.lateral == Lateral::periodic) s.steer_sides();
    if (!s.relaxing) s.harden(static_cast<double>(step() + steps / 2 - s.loading_start) * s.model.time_step);
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
    const double time = state_->model.time_step * static_cast<double>(step() - state_->segment_start);
    return state_->segment.strain_at(time);
}

std::vector<Vec3> Simulation::take_wall_forces() {
    const State& s = *state_;
    std::vector<Vec3> forces;
    for (FixSurface* wall : s.surfaces) {
        const FixSurface::Forces mine = wall->take_forces();
        Vec3 sum;
        for (int c = 0; c < 3; ++c) sum[c] = s.total(mine.sum[c]);
        forces.push_back(s.turned_back(sum) / (std::max(1L, mine.steps) * s.scale * s.scale));
    }
    return forces;
}

PlaneForces Simulation::take_forces() {
    if (state_->planes == nullptr) return {};
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

std::optional<double> Simulation::periodic_section() const {
    if (state_->model.lateral == Lateral::free) return {};
    const LAMMPS_NS::Domain& domain = *state_->session.lmp().domain;
    return domain.xprd * domain.yprd / (state_->scale * state_->scale);
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

double Simulation::initial_height() const {
    return state_->planes->motion().initial_height / state_->scale;
}

std::int64_t Simulation::particles() const {
    return std::llround(state_->total(state_->atom().nlocal));
}

std::int64_t Simulation::initial_particles() const {
    return state_->count;
}

double Simulation::seed_radius() const {
    return state_->model.seed_radius / state_->scale;
}

std::int64_t Simulation::particles_behind_planes() const {
    const State& s = *state_;
    if (s.planes == nullptr) return 0;
    const FixPlanes::Motion& motion = s.planes->motion();
    const double half_gap = 0.5 * motion.initial_height * std::exp(strain()) + motion.seed_radius;
    const LAMMPS_NS::Atom& atoms = state_->atom();
    double behind = 0;
    for (int i = 0; i < atoms.nlocal; ++i) behind += std::abs(atoms.x[i][2] - motion.centre[2]) > half_gap;
    return std::llround(state_->total(behind));
}

std::int64_t Simulation::neighbour_builds() const {
    return state_->builds();
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
    checkpoint.numbers["solver_loading_start"] = {static_cast<double>(s.loading_start)};
    checkpoint.numbers["solver_loading"] = {s.loading ? 1.0 : 0.0};
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
    s.loading_start = static_cast<std::int64_t>(found.checkpoint.number("solver_loading_start"));
    s.loading = found.checkpoint.number("solver_loading") != 0;
    rest();
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
            for (int c = 0; c < 3; ++c) memory.outward()[i][c] = std::bit_cast<double>(*word++);
            auto& interfaces = memory.interfaces(i);
            interfaces.resize(static_cast<std::size_t>(particles.memory_length[i] - 3) / 2);
            for (auto& one : interfaces) {
                one.partner = *word++;
                one.since = *word++;
            }
        }
    }
    if (const auto sides = found.checkpoint.numbers.find("solver_sides"); sides != found.checkpoint.numbers.end()) {
        s.add_sides();
        s.sides->restore(sides->second);
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

RowBlock Simulation::position_rows() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    return s.rows(3, [&](int i, int component) {
        Vec3 unwrapped;
        s.session.lmp().domain->unmap(atoms.x[i], atoms.image[i], unwrapped.data());
        return s.centre[component] + s.turned_back(unwrapped)[component] / s.scale;
    });
}

RowBlock Simulation::outward_rows() const {
    State& s = *state_;
    return s.rows(3, [&](int i, int component) {
        return s.contact == nullptr ? 0.0
                                    : s.turned_back(Vec3(s.contact->memory().outward()[i].data()))[component] / s.scale;
    });
}

RowBlock Simulation::velocity_rows() const {
    State& s = *state_;
    return s.rows(3, [&](int i, int component) { return s.turned_back(Vec3(s.atom().v[i]))[component] / s.scale; });
}

double Simulation::volume_per_particle() const {
    return state_->sample_volume / static_cast<double>(state_->count);
}

RowBlock Simulation::stress_rows() const {
    State& s = *state_;
    const LAMMPS_NS::Atom& atoms = s.atom();
    const auto mine = static_cast<std::size_t>(atoms.nlocal);
    constexpr int first[] = {0, 1, 2, 0, 0, 1}, second[] = {0, 1, 2, 1, 2, 2};
    const double over_volume = 1 / (volume_per_particle() * std::pow(s.scale, 3));
    std::vector<double> values(6 * mine);
    s.pair->tell_forces([&](int i, int j, const double* force, const double* apart) {
        for (int k = 0; k < 6; ++k) {
            // From the centre to the contact it is half the way to the neighbour.
            const double part = -0.5 * force[first[k]] * apart[second[k]] * over_volume;
            values[6 * static_cast<std::size_t>(i) + k] += part;
            if (j < atoms.nlocal) values[6 * static_cast<std::size_t>(j) + k] += part;
        }
    });
    for (std::size_t i = 0; i < mine; ++i) {
        if (s.planes != nullptr) values[6 * i + 2] += s.planes->tallied(static_cast<int>(i)) * over_volume;
        for (const FixSurface* surface : s.surfaces)
            for (int k = 0; k < 6; ++k) values[6 * i + k] += surface->tallied(static_cast<int>(i))[k] * over_volume;
        double turned[3][3];
        for (int k = 0; k < 6; ++k)
            turned[s.turned(first[k])][s.turned(second[k])] = turned[s.turned(second[k])][s.turned(first[k])] =
                values[6 * i + k];
        for (int k = 0; k < 6; ++k) values[6 * i + k] = turned[first[k]][second[k]];
    }
    return s.rows(6, [&](int i, int k) { return values[6 * static_cast<std::size_t>(i) + k]; });
}

std::vector<Vec3> Simulation::positions() const {
    State& s = *state_;
    std::vector<Vec3> unwrapped(s.atom().nlocal);
    std::vector<double*> rows;
    for (std::size_t i = 0; i < unwrapped.size(); ++i) {
        s.session.lmp().domain->unmap(s.atom().x[i], s.atom().image[i], unwrapped[i].data());
        rows.push_back(unwrapped[i].data());
    }
    std::vector<Vec3> points = s.gather(rows.data());
    for (Vec3& point : points) point = s.centre + s.turned_back(point) / s.scale;
    return points;
}

std::vector<Contact> Simulation::contacts() const {
    State& s = *state_;
    s.set_up_if_needed();
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
    s.set_up_if_needed();
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
    s.ready = false;
    s.set_up_if_needed();
    std::vector<Vec3> forces = s.gather(atoms.f);
    for (Vec3& force : forces) force = s.turned_back(force) / (s.scale * s.scale);
    return forces;
}

}  // namespace tomodem::plugin
