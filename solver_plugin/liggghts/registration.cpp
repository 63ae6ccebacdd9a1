#include "solver_plugin/liggghts/registration.hpp"

#include <algorithm>
#include <stdexcept>

#include "solver_plugin/liggghts/fix_contact.hpp"
#include "solver_plugin/liggghts/fix_exchange.hpp"
#include "solver_plugin/liggghts/fix_integrate.hpp"
#include "solver_plugin/liggghts/fix_rebuild.hpp"
#include "solver_plugin/liggghts/fix_watch.hpp"
#include "solver_plugin/liggghts/lateral_box.hpp"
#include "solver_plugin/liggghts/law_pair.hpp"
#include "solver_plugin/liggghts/planes.hpp"
#include "solver_plugin/liggghts/surfaces.hpp"

namespace tomodem::plugin {
namespace {

using namespace LAMMPS_NS;
using namespace LIGGGHTS;

using WallStyle = ContactModels::GranStyle<ContactModels::TOMODEM_LAW, 0, 0, 0, 0>;

/// LIGGGHTS' numbers of normal models go to 63; those of its own end at 11.
int model_number(const Law& law) {
    const std::vector<const Law*> all = solver_laws();
    return ContactModels::TOMODEM_LAW + static_cast<int>(std::find(all.begin(), all.end(), &law) - all.begin());
}

const Law& law_of(int64_t hashcode) {
    for (const Law* law : solver_laws())
        if (law_hashcode(*law) == hashcode) return *law;
    throw std::logic_error("no law has this number");
}

PairStyles::IGranularPairStyle* make_pair(LAMMPS* lmp, PairGran* owner, int64_t hashcode) {
    return new LawPair(lmp, owner, law_of(hashcode));
}

Walls::IGranularWall* make_wall(LAMMPS* lmp, FixWallGran* fix, int64_t hashcode) {
    LawPair* const pair = LawPair::of(*lmp);
    if (pair == nullptr || pair->hashcode() != hashcode)
        lmp->error->all(FLERR, "fix wall/gran needs the model of pair_style, which comes before it");
    return new Walls::Granular<ContactModels::ContactModel<WallStyle>>(lmp, fix, hashcode);
}

template <class Style>
Fix* make_fix(LAMMPS* lmp, int count, char** words) {
    return new Style(lmp, count, words);
}

// Modify::fix_map is private in the packaged headers and there is no call that adds a style. An explicit instantiation
// may name a private member ([temp.spec]), and hands it out through a friend.
template <class Tag, typename Tag::Member pointer>
struct Expose {
    friend typename Tag::Member member(Tag) { return pointer; }
};
struct FixMap {
    using Member = std::map<std::string, Fix* (*)(LAMMPS*, int, char**)>* Modify::*;
    friend Member member(FixMap);
};
template struct Expose<FixMap, &Modify::fix_map>;

}  // namespace

int64_t law_hashcode(const Law& law) {
    return Utils::generate_gran_hashcode(model_number(law), 0, 0, 0, 0);
}

void register_laws() {
    static bool done = false;
    if (done) return;
    done = true;
    for (const Law* law : solver_laws()) {
        ContactModels::Factory::instance().addNormalModel(law->name(), model_number(*law));
        const int hashcode = static_cast<int>(law_hashcode(*law));
        PairStyles::Factory::instance().addStyle("gran", hashcode, &make_pair);
        Walls::Factory::instance().addStyle("gran", hashcode, &make_wall);
    }
}

void register_fixes(LAMMPS& lmp) {
    auto& styles = *(lmp.modify->*member(FixMap()));
    styles["tomodem/planes"] = &make_fix<FixPlanes>;
    styles["tomodem/integrate"] = &make_fix<FixIntegrate>;
    styles["tomodem/surface"] = &make_fix<FixSurface>;
    styles["tomodem/lateral"] = &make_fix<FixLateralBox>;
    styles["tomodem/contact"] = &make_fix<FixContact>;
    styles["tomodem/rebuild"] = &make_fix<FixRebuild>;
    styles["tomodem/exchange"] = &make_fix<FixExchange>;
    styles["tomodem/watch"] = &make_fix<FixWatch>;
}

}  // namespace tomodem::plugin
