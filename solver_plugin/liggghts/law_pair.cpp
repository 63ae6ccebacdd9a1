#include "solver_plugin/liggghts/law_pair.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "solver_plugin/liggghts/fix_contact.hpp"
#include "solver_plugin/liggghts/planes.hpp"
#include "solver_plugin/liggghts/registration.hpp"
#include "solver_plugin/liggghts/script_wall.hpp"
#include "solver_plugin/liggghts/surfaces.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

namespace {

/// LIGGGHTS keeps the style behind a proxy that does not hand it out.
std::map<const LAMMPS*, LawPair*>& pair_styles() {
    static std::map<const LAMMPS*, LawPair*> styles;
    return styles;
}

}  // namespace

LawPair::LawPair(LAMMPS* lmp, PairGran* owner, const Law& law)
    : Pointers(lmp), owner_(owner), law_(law), solver_law_(make_solver_law(law)) {
    pair_styles()[lmp] = this;
    register_fixes(*lmp);
}

LawPair::~LawPair() {
    pair_styles().erase(lmp);
}

LawPair* LawPair::of(const LAMMPS& lmp) {
    const auto found = pair_styles().find(&lmp);
    return found == pair_styles().end() ? nullptr : found->second;
}

void LawPair::use(const PresentModel& present) {
    solver_law_->use(present);
    given_ = true;
}

/// The stock LIGGGHTS catches nothing.
template <class Do>
void LawPair::refuse_in_script(Do something) {
    try {
        something();
    } catch (const InvalidInput& refusal) {
        error->all(FLERR, refusal.what());
    }
}

void LawPair::init_granular() {
    const std::string name = "model " + law_.name();
    if (force->newton_pair) error->all(FLERR, (name + " needs 'newton off'").c_str());
    if (!given_) refuse_in_script([&] { solver_law_->connect(force->registry, name.c_str()); });
    // What a kernel looks for itself, LIGGGHTS need not; where it is asked for energies it does.
    if (kernel().finds_pairs() && given_)
        for (int k = 0; k < neighbor->nrequest; ++k)
            if (neighbor->requests[k]->requestor == owner_) neighbor->requests[k]->occasional = 1;
    const int fix = modify->find_fix("contact");
    contact_ = fix < 0 ? nullptr : dynamic_cast<FixContact*>(modify->fix[fix]);
    if (contact_ != nullptr && !law_.traits().self_contact)
        error->all(FLERR, (name + " cannot tell surfaces that meet from the pairs inside: remove fix contact, or take "
                                  "model trilin")
                              .c_str());
    if (kernel().exchanged() == 0) return;
    if (modify->find_fix("tomodem_exchange") < 0) {
        std::string words[] = {"tomodem_exchange", "all", "tomodem/exchange"};
        char* arguments[] = {words[0].data(), words[1].data(), words[2].data()};
        modify->add_fix(3, arguments);
    }
    Fix* const exchange = modify->fix[modify->find_fix("tomodem_exchange")];
    kernel().set_surroundings(this);
    kernel().set_exchange([this, exchange] { comm->forward_comm_fix(exchange); });
}

int64_t LawPair::hashcode() {
    return law_hashcode(law_);
}

bool LawPair::contact_match(const std::string type, const std::string model) {
    if (type == "normal") return model == law_.name();
    return model == "off" || model == "default";
}

void LawPair::write_restart_settings(FILE* file) {
    const int64_t code = hashcode();
    std::fwrite(&code, sizeof code, 1, file);
}

void LawPair::read_restart_settings(FILE* file, int64_t) {
    int64_t code = 0;
    if (comm->me == 0 && std::fread(&code, sizeof code, 1, file) != 1)
        error->one(FLERR, "cannot read the settings of the pair model");
}

/// Constants from `fix property/global`, for the radii that the particles have now.
void LawPair::read_properties() {
    // LIGGGHTS holds the constants of the types that occur, not of all that the box may hold.
    ScriptParticles particles{std::vector<double>(force->registry.max_type() + 1, 0.0), false};
    for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
        double& of_type = particles.crown_radius[atom->type[i]];
        if (of_type == 0.0) of_type = atom->radius[i];
        particles.dispersed = particles.dispersed || of_type != atom->radius[i];
    }
    refuse_in_script([&] { solver_law_->read(particles); });
}

ParticleView LawPair::particles() const {
    return {atom->x[0], atom->v[0], atom->radius, atom->type, atom->tag, atom->nlocal, atom->nlocal + atom->nghost,
            object_,    atom->rmass};
}

NeighbourView LawPair::list() const {
    const NeighList* const list = owner_->list;
    if (list == nullptr) return {};
    return {list->inum, list->ilist, list->numneigh, list->firstneigh, NEIGHMASK};
}

void LawPair::compute_force(PairGran* pair, int energy_flag, int virial_flag, int) {
    if (energy_flag || virial_flag)
        pair->ev_setup(energy_flag, virial_flag);
    else
        pair->evflag = pair->vflag_fdotr = 0;
    // An exchange is for all processes.
    if (atom->nlocal + atom->nghost == 0 && kernel().exchanged() == 0) return;
    PairStep step;
    step.number = update->ntimestep;
    step.time_step = update->dt;
    step.set_up = update->setupflag;
    step.renumbered = neighbor->ago == 0 || step.set_up;
    if (step.renumbered && !given_) read_properties();
    ContactMemory* const memory = contact_ == nullptr ? nullptr : &contact_->memory();
    if (memory != nullptr) step.renumbered = contact_->begin_step() || step.renumbered;

    const PairKernel::UsePair tally = [&](int i, int j, const double* force, const double* apart) {
        pair->ev_tally_xyz(i, j, atom->nlocal, 0, 0, 0, force[0], force[1], force[2], apart[0], apart[1], apart[2]);
    };
    step.velocity = atom->v[0];
    kernel().add_forces(particles(), list(), step, atom->f[0], memory, pair->evflag && !given_ ? &tally : nullptr);
    if (memory != nullptr) memory->finish_step();
}

void LawPair::solve_from(double start) {
    std::vector<double> forces(3 * static_cast<std::size_t>(atom->nlocal) + 1);
    solve(start, forces.data());
}

void LawPair::solve_again() {
    if (atom->nlocal > 0) std::fill_n(atom->f[0], 3 * atom->nlocal, 0.0);
    solve(0, atom->f[0]);
}

void LawPair::solve(double start, double* forces) {
    comm->forward_comm();
    PairStep step;
    step.number = update->ntimestep;
    step.time_step = update->dt;
    step.start = start;
    step.velocity = atom->v[0];
    step.set_up = false;
    kernel().add_forces(particles(), list(), step, forces, nullptr, nullptr);
}

void LawPair::add_up(double* values, std::size_t count) const {
    // The sum is made by one process: all have the same to the last bit.
    if (comm->nprocs == 1) return;
    const int size = static_cast<int>(count);
    if (comm->me == 0)
        MPI_Reduce(MPI_IN_PLACE, values, size, MPI_DOUBLE, MPI_SUM, 0, world);
    else
        MPI_Reduce(values, nullptr, size, MPI_DOUBLE, MPI_SUM, 0, world);
    MPI_Bcast(values, size, MPI_DOUBLE, 0, world);
}

void LawPair::take_largest(double* values, std::size_t count) const {
    MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_MAX, world);
}

/// A script may give that name to a fix of another style.
const FixPlanes* LawPair::fix_planes() const {
    const int planes = modify->find_fix("planes");
    return planes < 0 ? nullptr : dynamic_cast<const FixPlanes*>(modify->fix[planes]);
}

double LawPair::rate(double start) const {
    const FixPlanes* const planes = fix_planes();
    return planes == nullptr ? 0 : std::abs(planes->rate(start));
}

std::vector<NearWall> LawPair::planes(double start, double interval) const {
    std::vector<NearWall> walls;
    if (const FixPlanes* const planes = fix_planes())
        planes->add_walls(start, interval, 0, atom->nlocal + atom->nghost, walls);
    return walls;
}

std::vector<NearWall> LawPair::walls(double start, double interval) const {
    std::vector<NearWall> walls;
    // A surface may touch a particle in several places.
    constexpr int most_contacts = 64;
    int number = 0;
    for (int k = 0; k < modify->nfix; ++k) {
        if (const auto* planes = dynamic_cast<const FixPlanes*>(modify->fix[k]))
            planes->add_walls(start, interval, number, atom->nlocal, walls);
        else if (const auto* surface = dynamic_cast<const FixSurface*>(modify->fix[k]))
            surface->add_walls(start, interval, number, walls);
        else
            continue;
        number += most_contacts;
    }
    return walls;
}

double LawPair::lateral_virial() const {
    double virial = 0;
    pair_forces([&](int, int j, const double* force, const double* apart) {
        // A pair across a process boundary or a periodic side is seen from both sides.
        const double share = j < atom->nlocal ? 1.0 : 0.5;
        virial += share * 0.5 * (force[0] * apart[0] + force[1] * apart[1]);
    });
    return virial;
}

Vec3 LawPair::virial() const {
    double sums[3] = {0, 0, 0};
    pair_forces([&](int, int j, const double* force, const double* apart) {
        const double share = j < atom->nlocal ? 1.0 : 0.5;
        for (int c = 0; c < 3; ++c) sums[c] += share * force[c] * apart[c];
    });
    add_up(sums, 3);
    return Vec3(sums);
}

void LawPair::pair_forces(const PairKernel::UsePair& use) const {
    if (kernel().finds_velocities()) {
        kernel().pair_forces(particles(), list(), nullptr, use);
        return;
    }
    // Ghosts still hold the velocities of the half step; those of this process have been kicked since.
    std::vector<double> velocity(3 * static_cast<std::size_t>(atom->nlocal + atom->nghost));
    for (int i = 0; i < atom->nlocal + atom->nghost; ++i)
        for (int c = 0; c < 3; ++c) {
            const double kick = i < atom->nlocal ? 0.5 * update->dt / atom->rmass[i] * atom->f[i][c] : 0.0;
            velocity[3 * i + c] = atom->v[i][c] - kick;
        }
    ParticleView view = particles();
    view.velocity = velocity.data();
    kernel().pair_forces(view, list(), contact_ == nullptr ? nullptr : &contact_->memory(), use);
}

double LawPair::wall_force(int i, double distance, const double* normal, double rate, int plane) const {
    double other = 0;
    for (int c = 0; c < 3; ++c) other += normal[c] * atom->f[i][c];
    return kernel().wall_force({i,
                                atom->type[i],
                                atom->radius[i],
                                distance,
                                rate,
                                other,
                                update->dt / atom->rmass[i],
                                {normal[0], normal[1], normal[2]},
                                plane});
}

double script_wall_force(LAMMPS& lmp, int i, double distance, const double* normal, double rate) {
    return LawPair::of(lmp)->wall_force(i, distance, normal, rate);
}

}  // namespace tomodem::plugin
