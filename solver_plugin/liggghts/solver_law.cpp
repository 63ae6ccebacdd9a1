#include "solver_plugin/liggghts/solver_law.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/base/error.hpp"

namespace tomodem::plugin {
namespace {

using Entry = std::pair<const Law*, SolverLawRegistration::Make>;

std::vector<Entry>& registry() {
    static std::vector<Entry> all{
        {&bilin_law(), &make_bilin}, {&trilin_law(), &make_trilin}, {&norton_law(), &make_norton}};
    return all;
}

}  // namespace

SolverLawRegistration::SolverLawRegistration(const Law& law, Make make) {
    registry().emplace_back(&law, make);
}

std::vector<const Law*> solver_laws() {
    std::vector<const Law*> all;
    for (const auto& [law, make] : registry()) all.push_back(law);
    return all;
}

std::unique_ptr<SolverLaw> make_solver_law(const Law& law) {
    for (const auto& [known, make] : registry())
        if (known == &law) return make();
    throw InvalidInput(fmt::format("the solver does not know law \"{}\"", law.name()));
}

void SolverLaw::connect(PropertyRegistry&, const char* caller) {
    throw InvalidInput(fmt::format("{} takes its constants from a scene alone, not from an input script", caller));
}

}  // namespace tomodem::plugin
