#include <algorithm>
#include <cmath>
#include <optional>

#include "solver_plugin/simulation/simulation_state.hpp"

namespace tomodem::plugin {

/// Some particles at a time: a whole second copy would be the highest peak of memory.
RowBlock Simulation::State::rows(int components, const std::function<double(int, int)>& value) {
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
            for (int component = 0; component < components; ++component) out[at + 1 + component] = value(i, component);
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

std::vector<Vec3> Simulation::State::gather(double* const* local) {
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
    MPI_Gatherv(first, 3 * mine, MPI_DOUBLE, values.data(), triple_counts.data(), triple_starts.data(), MPI_DOUBLE, 0,
                communicator);
    std::vector<Vec3> result(rank == 0 ? count : 0);
    for (std::size_t k = 0; k < tags.size(); ++k)
        result[tags[k] - 1] = Vec3(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
    return result;
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

ForceBalance Simulation::force_balance() {
    State& s = *state_;
    struct Forces {
        std::vector<int> tags;
        std::vector<Vec3> net;
        double load = 0;
    };
    const auto look = [&] {
        const LAMMPS_NS::Atom& atoms = s.atom();
        Forces seen{{atoms.tag, atoms.tag + atoms.nlocal}, {}, 0};
        seen.net.assign(seen.tags.size(), Vec3::Zero());
        s.pair->pair_forces([&](int i, int j, const double* force, const double*) {
            const Vec3 vector(force);
            const double size = vector.norm();
            seen.net[static_cast<std::size_t>(i)] += vector;
            seen.load += size;
            if (j >= atoms.nlocal) return;
            seen.net[static_cast<std::size_t>(j)] -= vector;
            seen.load += size;
        });
        return seen;
    };
    run(1);
    Forces before = look();
    for (;;) {
        run(1);
        Forces after = look();
        // Particles change their places and processes when neighbours are listed anew: seldom.
        if (s.largest(before.tags == after.tags ? 0 : 1) == 0) {
            double squares = 0;
            for (std::size_t i = 0; i < after.net.size(); ++i)
                squares += ((before.net[i] + after.net[i]) / 2).squaredNorm();
            const double count = static_cast<double>(s.count), to_sample = 1 / (s.scale * s.scale);
            return {std::sqrt(s.total(squares) / count) * to_sample,
                    s.total((before.load + after.load) / 2) / count * to_sample};
        }
        before = std::move(after);
    }
}

double Simulation::flow_energy() const {
    State& s = *state_;
    if (s.planes == nullptr) return 0;
    const double rate = s.segment.rate_at(s.time_in_segment());
    const LAMMPS_NS::Atom& atoms = s.atom();
    const double* const centre = s.planes->motion().centre;
    double energy = 0;
    for (int i = 0; i < atoms.nlocal; ++i) {
        const double x = atoms.x[i][0] - centre[0], y = atoms.x[i][1] - centre[1], z = atoms.x[i][2] - centre[2];
        energy += 0.5 * atoms.rmass[i] * rate * rate * (z * z + 0.25 * (x * x + y * y));
    }
    return s.total(energy) / std::pow(s.scale, 3);
}

std::optional<double> Simulation::periodic_section() const {
    if (state_->model.lateral == Lateral::free) return {};
    const LAMMPS_NS::Domain& domain = *state_->session.lmp().domain;
    return domain.xprd * domain.yprd / (state_->scale * state_->scale);
}

double Simulation::max_kinetic_energy_of_a_phase() const {
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

double Simulation::axial_virial() const {
    const State& s = *state_;
    double walls = s.planes == nullptr ? 0 : s.planes->virial();
    for (const FixSurface* surface : s.surfaces) walls += surface->virial();
    return (s.total(walls) - s.pair->virial()[2]) / std::pow(s.scale, 3);
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

std::int64_t Simulation::evaluations() const {
    const FlowWork* const work = state_->pair->kernel().work();
    return work == nullptr ? 0 : work->evaluations();
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
    s.pair->pair_forces([&](int i, int j, const double* force, const double* apart) {
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

}  // namespace tomodem::plugin
