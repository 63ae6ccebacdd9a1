#include "solver_plugin/liggghts/fix_contact.hpp"

#include <cmath>
#include <cstdlib>
#include <string>

namespace tomodem::plugin {

using namespace LAMMPS_NS;

namespace {

/// Steps between two looks at the ages of interfaces; a fixed number, so that it is the same on every process.
constexpr std::int64_t healing_interval = 50;

}  // namespace

FixContact::FixContact(LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) {
    for (int k = 3; k < count; k += 2) {
        const std::string key = words[k], value = k + 1 < count ? words[k + 1] : "";
        char* end = nullptr;
        const double number = std::strtod(value.c_str(), &end);
        const bool positive = !value.empty() && *end == '\0' && number > 0;
        if (key == "seed_radius" && positive)
            memory_.set_law({.min_outward = law::SelfContact::outward_over_seed * number});
        else if (key == "healing_steps" && positive)
            heal_after(std::llround(number));
        else
            error->fix_error(FLERR, this, "expected seed_radius LENGTH and, if contacts heal, healing_steps STEPS");
    }
    comm_forward = 3;
    grow_arrays(atom->nmax);
    atom->add_callback(0);
}

FixContact::~FixContact() {
    atom->delete_callback(id, 0);
}

int FixContact::setmask() {
    return FixConst::PRE_FORCE;
}

bool FixContact::begin_step() {
    memory_.resize(atom->nlocal, atom->nghost);
    if (healing_steps_ == never || update->ntimestep % healing_interval != 0) return false;
    return memory_.heal(update->ntimestep, healing_steps_) > 0;
}

void FixContact::pre_force(int) {
    memory_.resize(atom->nlocal, atom->nghost);
    comm->forward_comm_fix(this);
}

void FixContact::grow_arrays(int count) {
    memory_.resize(count, 0);
}

void FixContact::copy_arrays(int from, int to, int) {
    memory_.outward()[to] = memory_.outward()[from];
    memory_.interfaces(to) = memory_.interfaces(from);
}

void FixContact::set_arrays(int i) {
    memory_.outward()[i] = {};
    memory_.interfaces(i).clear();
}

int FixContact::pack_exchange(int i, double* buffer) {
    int m = 0;
    for (int c = 0; c < 3; ++c) buffer[m++] = memory_.outward()[i][c];
    const auto& interfaces = memory_.interfaces(i);
    buffer[m++] = static_cast<double>(interfaces.size());
    for (const ContactMemory::Interface& one : interfaces) {
        buffer[m++] = static_cast<double>(one.partner);
        buffer[m++] = static_cast<double>(one.since);
    }
    return m;
}

int FixContact::unpack_exchange(int i, double* buffer) {
    int m = 0;
    for (int c = 0; c < 3; ++c) memory_.outward()[i][c] = buffer[m++];
    auto& interfaces = memory_.interfaces(i);
    interfaces.resize(static_cast<std::size_t>(buffer[m++]));
    for (ContactMemory::Interface& one : interfaces) {
        one.partner = static_cast<std::int64_t>(buffer[m++]);
        one.since = static_cast<std::int64_t>(buffer[m++]);
    }
    return m;
}

int FixContact::pack_comm(int count, int* list, double* buffer, int, int*) {
    int m = 0;
    for (int k = 0; k < count; ++k)
        for (int c = 0; c < 3; ++c) buffer[m++] = memory_.outward()[list[k]][c];
    return 3;
}

void FixContact::unpack_comm(int count, int first, double* buffer) {
    int m = 0;
    for (int k = 0; k < count; ++k)
        for (int c = 0; c < 3; ++c) memory_.outward()[first + k][c] = buffer[m++];
}

}  // namespace tomodem::plugin
