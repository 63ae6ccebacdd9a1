#include "tests/unit/solver/simulation_probe.hpp"

#include <algorithm>

#include "solver_plugin/simulation/simulation_state.hpp"

namespace tomodem::plugin {
namespace {

/// The items of every process one after the other, on the first process.
template <class State, class Item>
std::vector<Item> gather_all(const State& s, const std::vector<Item>& mine) {
    int processes = 1;
    MPI_Comm_size(s.communicator, &processes);
    MPI_Datatype item;
    MPI_Type_contiguous(sizeof(Item), MPI_BYTE, &item);
    MPI_Type_commit(&item);
    const int count = static_cast<int>(mine.size());
    std::vector<int> counts(processes), starts(processes + 1);
    MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, s.communicator);
    for (int p = 0; p < processes; ++p) starts[p + 1] = starts[p] + counts[p];
    std::vector<Item> all(s.rank == 0 ? starts.back() : 0);
    MPI_Gatherv(mine.data(), count, item, all.data(), counts.data(), starts.data(), item, 0, s.communicator);
    MPI_Type_free(&item);
    return all;
}

}  // namespace

std::vector<Contact> SimulationProbe::contacts() const {
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
                    contact.age = s.session.lmp().update->ntimestep - known.since;
                }
        mine.push_back(contact);
    });
    std::vector<Contact> all = gather_all(s, mine);
    std::sort(all.begin(), all.end());
    return all;
}

std::vector<Vec3> SimulationProbe::outward_vectors() const {
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

std::vector<int> SimulationProbe::owners() const {
    State& s = *state_;
    struct Owner {
        int tag, rank;
    };
    std::vector<Owner> mine;
    for (int i = 0; i < s.atom().nlocal; ++i) mine.push_back({s.atom().tag[i], s.rank});
    std::vector<int> owners(s.rank == 0 ? s.count : 0);
    for (const Owner& owner : gather_all(s, mine)) owners[owner.tag - 1] = owner.rank;
    return owners;
}

std::array<int, 3> SimulationProbe::process_grid() const {
    const int* const grid = state_->session.lmp().comm->procgrid;
    return {grid[0], grid[1], grid[2]};
}

std::vector<Vec3> SimulationProbe::forces_at(const std::vector<Vec3>& velocities) {
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
