#include "solver_plugin/bilin_pair.hpp"

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "solver_plugin/registration.hpp"

namespace tomodem::plugin {

using namespace LAMMPS_NS;

namespace {

/// Inner over outer skin: prunings cost little, padding pairs cost much.
constexpr double inner_skin_share = 0.25;

}  // namespace

void BilinPair::init_granular() {
    properties_.connect(force->registry, "model bilin");
}

int64_t BilinPair::hashcode() {
    return bilin_hashcode();
}

bool BilinPair::contact_match(const std::string type, const std::string model) {
    if (type == "normal") return model == "bilin";
    return model == "off" || model == "default";
}

void BilinPair::write_restart_settings(FILE* file) {
    const int64_t code = hashcode();
    std::fwrite(&code, sizeof code, 1, file);
}

void BilinPair::read_restart_settings(FILE* file, int64_t) {
    int64_t code = 0;
    if (comm->me == 0 && std::fread(&code, sizeof code, 1, file) != 1)
        error->one(FLERR, "cannot read the settings of model bilin");
}

void BilinPair::compute_force(PairGran* pair, int energy_flag, int virial_flag, int) {
    if (energy_flag || virial_flag)
        pair->ev_setup(energy_flag, virial_flag);
    else
        pair->evflag = pair->vflag_fdotr = 0;
    const bool rebuilt = neighbor->ago == 0 || update->setupflag;
    if (rebuilt) vector_ready_ = prepare_vector();
    if (vector_ready_ && !pair->evflag)
        compute_vector(*pair);
    else
        compute_scalar(*pair);
}

bool BilinPair::prepare_vector() {
    const char* const kernel = std::getenv("TOMODEM_KERNEL");
    const bool wanted = kernel == nullptr || std::string_view(kernel) != "scalar";
    if (!wanted || !VectorPairs::supported() || force->newton_pair) return false;
    // LIGGGHTS holds the constants of the types that occur, not of all that the box may hold.
    const int types = force->registry.max_type();
    std::vector<double> radius(types + 1, 0.0);
    for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
        double& of_type = radius[atom->type[i]];
        if (of_type == 0.0) of_type = atom->radius[i];
        if (of_type != atom->radius[i]) return false;
    }
    std::vector<law::Bilin> laws;
    for (int a = 1; a <= types; ++a)
        for (int b = 1; b <= types; ++b) {
            const double crown = radius[a] + radius[b];
            laws.push_back({crown * properties_.seed_to_crown, crown, properties_.repulsive_stiffness[a][b],
                            properties_.attractive_stiffness[a][b]});
        }
    vector_pairs_.set_laws(std::move(laws), types, inner_skin_share * neighbor->skin);
    return true;
}

void BilinPair::compute_vector(PairGran& pair) {
    const NeighList& list = *pair.list;
    const int count = atom->nlocal + atom->nghost;
    if (count == 0) return;
    vector_pairs_.add_forces({atom->x[0], atom->v[0], atom->type, atom->nlocal, count},
                             {list.inum, list.ilist, list.numneigh, list.firstneigh, NEIGHMASK},
                             neighbor->ago == 0 || update->setupflag, atom->f[0]);
}

void BilinPair::compute_scalar(PairGran& pair) {
    const bool tally = pair.evflag != 0;

    const double* const* x = atom->x;
    const double* const* v = atom->v;
    double* const* f = atom->f;
    const double* radius = atom->radius;
    const int* type = atom->type;
    const int local_count = atom->nlocal;
    const bool newton = force->newton_pair != 0;
    const NeighList& list = *pair.list;

    for (int row = 0; row < list.inum; ++row) {
        const int i = list.ilist[row];
        const double* const stiffness = properties_.repulsive_stiffness[type[i]];
        const double* const attraction = properties_.attractive_stiffness[type[i]];
        double sum[3] = {0, 0, 0};
        for (int entry = 0; entry < list.numneigh[i]; ++entry) {
            const int j = list.firstneigh[i][entry] & NEIGHMASK;
            const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1], dz = x[i][2] - x[j][2];
            const double squared = dx * dx + dy * dy + dz * dz;
            const double crown = radius[i] + radius[j];
            if (squared >= crown * crown) continue;
            const double distance = std::sqrt(squared);
            // Only the sign of the rate counts: the division by the distance is left out.
            const double rate = dx * (v[i][0] - v[j][0]) + dy * (v[i][1] - v[j][1]) + dz * (v[i][2] - v[j][2]);
            const law::Bilin law{crown * properties_.seed_to_crown, crown, stiffness[type[j]], attraction[type[j]]};
            const double over_distance = law::bilin_force(law, distance, rate) / distance;
            const double fx = over_distance * dx, fy = over_distance * dy, fz = over_distance * dz;
            sum[0] += fx;
            sum[1] += fy;
            sum[2] += fz;
            if (newton || j < local_count) {
                f[j][0] -= fx;
                f[j][1] -= fy;
                f[j][2] -= fz;
            }
            if (tally) pair.ev_tally_xyz(i, j, local_count, newton, 0, 0, fx, fy, fz, dx, dy, dz);
        }
        f[i][0] += sum[0];
        f[i][1] += sum[1];
        f[i][2] += sum[2];
    }
}

double seed_energy(LAMMPS* lmp) {
    auto* pair = static_cast<PairGran*>(lmp->force->pair);
    BilinProperties properties;
    properties.connect(lmp->force->registry, "seed energy");
    const Atom& atom = *lmp->atom;
    const NeighList& list = *pair->list;
    double energy = 0;
    for (int row = 0; row < list.inum; ++row) {
        const int i = list.ilist[row];
        for (int entry = 0; entry < list.numneigh[i]; ++entry) {
            const int j = list.firstneigh[i][entry] & NEIGHMASK;
            double squared = 0;
            for (int axis = 0; axis < 3; ++axis) squared += std::pow(atom.x[i][axis] - atom.x[j][axis], 2);
            const double overlap = (atom.radius[i] + atom.radius[j]) * properties.seed_to_crown - std::sqrt(squared);
            if (overlap <= 0) continue;
            // A pair across a process boundary is seen from both sides.
            const double share = j < atom.nlocal || lmp->force->newton_pair ? 1.0 : 0.5;
            energy += share * 0.5 * properties.repulsive_stiffness[atom.type[i]][atom.type[j]] * overlap * overlap;
        }
    }
    return energy;
}

}  // namespace tomodem::plugin
