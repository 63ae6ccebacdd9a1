#include "solver_plugin/registration.hpp"

#include "solver_plugin/bilin_pair.hpp"
#include "solver_plugin/planes.hpp"

namespace tomodem::plugin {
namespace {

using namespace LAMMPS_NS;
using namespace LIGGGHTS;

using BilinStyle = ContactModels::GranStyle<ContactModels::TOMODEM_BILIN, 0, 0, 0, 0>;
using BilinWall = Walls::Granular<ContactModels::ContactModel<BilinStyle>>;

PairStyles::IGranularPairStyle* make_pair(LAMMPS* lmp, PairGran*, int64_t) {
    return new BilinPair(lmp);
}
Walls::IGranularWall* make_wall(LAMMPS* lmp, FixWallGran* fix, int64_t hash) {
    return new BilinWall(lmp, fix, hash);
}
Fix* make_planes(LAMMPS* lmp, int count, char** words) {
    return new FixPlanes(lmp, count, words);
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

int64_t bilin_hashcode() {
    return BilinStyle::HASHCODE;
}

void register_laws() {
    static bool done = false;
    if (done) return;
    done = true;
    ContactModels::Factory::instance().addNormalModel("bilin", ContactModels::TOMODEM_BILIN);
    PairStyles::Factory::instance().addStyle("gran", BilinStyle::HASHCODE, &make_pair);
    Walls::Factory::instance().addStyle("gran", BilinStyle::HASHCODE, &make_wall);
}

void register_fixes(LAMMPS& lmp) {
    (*(lmp.modify->*member(FixMap())))["tomodem/planes"] = &make_planes;
}

}  // namespace tomodem::plugin
