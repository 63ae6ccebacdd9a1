#include "solver_plugin/liggghts/crown_pair.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>

#include "solver_plugin/liggghts/fix_contact.hpp"
#include "solver_plugin/liggghts/fix_norton.hpp"
#include "solver_plugin/liggghts/registration.hpp"
#include "solver_plugin/pairs/scalar_pairs.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

namespace {

/// Skin of the vector loop's own list over the crown: small where particles move little (BILIN), as every candidate
/// costs, larger where they are hot (TRILIN) and lists age fast.
double inner_skin(bool trilin, double greatest_crown_distance) {
    return (trilin ? 0.15 : 0.05) * greatest_crown_distance;
}

bool scalar_asked_for() {
    const char* const kernel = std::getenv("TOMODEM_KERNEL");
    return kernel != nullptr && std::string_view(kernel) == "scalar";
}

/// LIGGGHTS keeps the style behind a proxy that does not hand it out.
std::map<const LAMMPS*, CrownPair*>& pair_styles() {
    static std::map<const LAMMPS*, CrownPair*> styles;
    return styles;
}

NeighbourView view(const NeighList& list) {
    return {list.inum, list.ilist, list.numneigh, list.firstneigh, NEIGHMASK};
}

}  // namespace

CrownPair::CrownPair(LAMMPS* lmp, PairGran* owner, bool trilin) : Pointers(lmp), owner_(owner), trilin_(trilin) {
    pair_styles()[lmp] = this;
}

CrownPair::~CrownPair() {
    pair_styles().erase(lmp);
}

CrownPair* CrownPair::of(const LAMMPS& lmp) {
    const auto found = pair_styles().find(&lmp);
    return found == pair_styles().end() ? nullptr : found->second;
}

void CrownPair::use(const PairLaws& laws) {
    laws_ = laws;
    given_ = new_laws_ = true;
}

void CrownPair::use(const law::Norton& law) {
    if (!VectorPairs::supported())
        error->all(FLERR, "law norton needs a processor with AVX2 and FMA, as x86-64 ones have since 2013");
    norton_pairs_.set_law(law, inner_skin(false, law::NortonConstants::crown * law.seed_diameter));
    norton_ = given_ = true;
}

void CrownPair::init_granular() {
    if (force->newton_pair) error->all(FLERR, "models bilin and trilin need 'newton off'");
    if (!given_) properties_.connect(force->registry, trilin_, trilin_ ? "model trilin" : "model bilin");
    const int fix = modify->find_fix("contact");
    vectorised_ = VectorPairs::supported() && (norton_ || !scalar_asked_for());
    // What the scene's loop looks for itself, LIGGGHTS need not.
    if (vectorised_ && given_)
        for (int k = 0; k < neighbor->nrequest; ++k)
            if (neighbor->requests[k]->requestor == owner_) neighbor->requests[k]->occasional = 1;
    contact_ = fix < 0 ? nullptr : dynamic_cast<FixContact*>(modify->fix[fix]);
    const int states = modify->find_fix("norton");
    norton_states_ = states < 0 ? nullptr : dynamic_cast<FixNorton*>(modify->fix[states]);
}

int64_t CrownPair::hashcode() {
    return law_hashcode(trilin_);
}

bool CrownPair::contact_match(const std::string type, const std::string model) {
    if (type == "normal") return model == (trilin_ ? "trilin" : "bilin");
    return model == "off" || model == "default";
}

void CrownPair::write_restart_settings(FILE* file) {
    const int64_t code = hashcode();
    std::fwrite(&code, sizeof code, 1, file);
}

void CrownPair::read_restart_settings(FILE* file, int64_t) {
    int64_t code = 0;
    if (comm->me == 0 && std::fread(&code, sizeof code, 1, file) != 1)
        error->one(FLERR, "cannot read the settings of the pair model");
}

/// Laws from `fix property/global`, for the radii that the particles have now.
void CrownPair::read_properties() {
    // LIGGGHTS holds the constants of the types that occur, not of all that the box may hold.
    const int types = force->registry.max_type();
    std::vector<double> radius(types + 1, 0.0);
    laws_.dispersed = false;
    for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
        double& of_type = radius[atom->type[i]];
        if (of_type == 0.0) of_type = atom->radius[i];
        laws_.dispersed = laws_.dispersed || of_type != atom->radius[i];
    }
    laws_.type_count = types;
    laws_.seed_to_crown = properties_.seed_to_crown();
    laws_.of_types.clear();
    for (int a = 1; a <= types; ++a)
        for (int b = 1; b <= types; ++b) laws_.of_types.push_back(properties_.pair(a, b, radius[a] + radius[b]));
    new_laws_ = true;
}

ParticleView CrownPair::particles() const {
    return {atom->x[0], atom->v[0], atom->radius, atom->type, atom->tag, atom->nlocal, atom->nlocal + atom->nghost,
            object_};
}

void CrownPair::compute_force(PairGran* pair, int energy_flag, int virial_flag, int) {
    if (energy_flag || virial_flag)
        pair->ev_setup(energy_flag, virial_flag);
    else
        pair->evflag = pair->vflag_fdotr = 0;
    // The exchange of NORTON's states is for all processes.
    if (atom->nlocal + atom->nghost == 0 && !norton_) return;
    PairStep step;
    step.number = update->ntimestep;
    step.time_step = update->dt;
    step.set_up = update->setupflag;
    step.renumbered = neighbor->ago == 0 || step.set_up;
    if (step.renumbered && !given_) read_properties();
    ContactMemory* const memory = contact_ == nullptr ? nullptr : &contact_->memory();
    if (memory != nullptr) step.renumbered = contact_->begin_step() || step.renumbered;

    if (norton_) {
        norton_pairs_.add_forces(particles(), step, atom->f[0], memory, [this] { norton_states_->exchange(); });
    } else if (vectorised_ && (given_ || !pair->evflag)) {
        if (new_laws_) {
            double crown = 0;
            for (const law::Pair& law : laws_.of_types) crown = std::max(crown, law.crown_distance);
            vector_pairs_.set_laws(laws_, inner_skin(trilin_, crown));
        }
        new_laws_ = false;
        vector_pairs_.add_forces(particles(), step, atom->f[0], memory);
    } else {
        const auto tally = [&](int i, int j, const double* force, const double* apart) {
            if (pair->evflag)
                pair->ev_tally_xyz(i, j, atom->nlocal, 0, 0, 0, force[0], force[1], force[2], apart[0], apart[1],
                                   apart[2]);
        };
        scalar_pairs(laws_, particles(), view(*pair->list), step, atom->f[0], memory, tally);
    }
    if (memory != nullptr) memory->finish_step();
}

double CrownPair::lateral_virial() {
    double virial = 0;
    tell_forces([&](int, int j, const double* force, const double* apart) {
        // A pair across a process boundary or a periodic side is seen from both sides.
        const double share = j < atom->nlocal ? 1.0 : 0.5;
        virial += share * 0.5 * (force[0] * apart[0] + force[1] * apart[1]);
    });
    return virial;
}

double CrownPair::seed_energy() {
    if (vectorised_ && !norton_) return vector_pairs_.seed_energy(atom->nlocal);
    double energy = 0;
    for_each_pair([&](int i, int j) {
        double squared = 0;
        for (int axis = 0; axis < 3; ++axis) squared += std::pow(atom->x[i][axis] - atom->x[j][axis], 2);
        const double seeds = norton_ ? law::NortonConstants::core * norton_pairs_.law().seed_diameter
                                     : (atom->radius[i] + atom->radius[j]) * laws_.seed_to_crown;
        if (squared >= seeds * seeds) return;
        const double stiffness =
            norton_ ? law::NortonConstants::core_stiffness * norton_pairs_.law().seed_diameter *
                          (norton_pairs_.state(i).strength() + norton_pairs_.state(j).strength()) / 2
                    : laws_.of_types[(atom->type[i] - 1) * laws_.type_count + atom->type[j] - 1].repulsive_stiffness;
        // A pair across a process boundary is seen from both sides.
        const double share = j < atom->nlocal ? 1.0 : 0.5;
        energy += share * 0.5 * stiffness * std::pow(seeds - std::sqrt(squared), 2);
    });
    return energy;
}

void CrownPair::tell_forces(const std::function<void(int, int, const double*, const double*)>& tell) {
    // Ghosts still hold the velocities of the half step; those of this process have been kicked since.
    std::vector<double> velocity(3 * static_cast<std::size_t>(atom->nlocal + atom->nghost));
    for (int i = 0; i < atom->nlocal + atom->nghost; ++i)
        for (int c = 0; c < 3; ++c) {
            const double kick = i < atom->nlocal ? 0.5 * update->dt / atom->rmass[i] * atom->f[i][c] : 0.0;
            velocity[3 * i + c] = atom->v[i][c] - kick;
        }
    const ContactMemory* const memory = contact_ == nullptr ? nullptr : &contact_->memory();
    if (norton_) {
        const ParticleView view = particles();
        const double reach = law::NortonConstants::crown * norton_pairs_.law().seed_diameter;
        for_each_pair([&](int i, int j) {
            double apart[3], speed[3], squared = 0, force[3];
            for (int c = 0; c < 3; ++c) {
                apart[c] = atom->x[i][c] - atom->x[j][c];
                speed[c] = velocity[3 * i + c] - velocity[3 * j + c];
                squared += apart[c] * apart[c];
            }
            if (squared > reach * reach) return;
            law::norton_force(norton_pairs_.law(), norton_pairs_.state(i), norton_pairs_.state(j), apart, speed,
                              norton_pairs_.bonded(view, i, j, memory), force);
            tell(i, j, force, apart);
        });
        return;
    }
    for_each_pair([&](int i, int j) {
        law::Pair law = laws_.of_types[(atom->type[i] - 1) * laws_.type_count + atom->type[j] - 1];
        if (laws_.dispersed) {
            law.crown_distance = atom->radius[i] + atom->radius[j];
            law.seed_distance = law.crown_distance * laws_.seed_to_crown;
        }
        double apart[3], squared = 0, rate = 0;
        for (int c = 0; c < 3; ++c) {
            apart[c] = atom->x[i][c] - atom->x[j][c];
            squared += apart[c] * apart[c];
            rate += apart[c] * (velocity[3 * i + c] - velocity[3 * j + c]);
        }
        if (squared > law.crown_distance * law.crown_distance) return;
        const bool same_object = object_ == nullptr || object_[atom->tag[i] - 1] == object_[atom->tag[j] - 1];
        if (!same_object || (memory != nullptr && memory->is_interface(i, atom->tag[j]))) law.greatest_attraction = 0;
        const double distance = std::sqrt(squared);
        const double over_distance = law::pair_force(law, distance, rate) / distance;
        const double force[3] = {over_distance * apart[0], over_distance * apart[1], over_distance * apart[2]};
        tell(i, j, force, apart);
    });
}

}  // namespace tomodem::plugin
