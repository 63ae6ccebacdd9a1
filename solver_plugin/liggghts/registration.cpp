#include "solver_plugin/liggghts/registration.hpp"

#include "solver_plugin/liggghts/crown_pair.hpp"
#include "solver_plugin/liggghts/fix_contact.hpp"
#include "solver_plugin/liggghts/fix_integrate.hpp"
#include "solver_plugin/liggghts/fix_norton.hpp"
#include "solver_plugin/liggghts/fix_rebuild.hpp"
#include "solver_plugin/liggghts/fix_watch.hpp"
#include "solver_plugin/liggghts/lateral_box.hpp"
#include "solver_plugin/liggghts/planes.hpp"
#include "solver_plugin/liggghts/surfaces.hpp"

namespace tomodem::plugin {
namespace {

using namespace LAMMPS_NS;
using namespace LIGGGHTS;

using BilinStyle = ContactModels::GranStyle<ContactModels::TOMODEM_BILIN, 0, 0, 0, 0>;
using TrilinStyle = ContactModels::GranStyle<ContactModels::TOMODEM_TRILIN, 0, 0, 0, 0>;

template <bool trilin>
PairStyles::IGranularPairStyle* make_pair(LAMMPS* lmp, PairGran* owner, int64_t) {
    return new CrownPair(lmp, owner, trilin);
}
template <class Style>
Walls::IGranularWall* make_wall(LAMMPS* lmp, FixWallGran* fix, int64_t hash) {
    return new Walls::Granular<ContactModels::ContactModel<Style>>(lmp, fix, hash);
}
template <class Style, bool trilin>
void add_law(const char* name, int model) {
    ContactModels::Factory::instance().addNormalModel(name, model);
    PairStyles::Factory::instance().addStyle("gran", Style::HASHCODE, &make_pair<trilin>);
    Walls::Factory::instance().addStyle("gran", Style::HASHCODE, &make_wall<Style>);
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

int64_t law_hashcode(bool trilin) {
    return trilin ? TrilinStyle::HASHCODE : BilinStyle::HASHCODE;
}

void register_laws() {
    static bool done = false;
    if (done) return;
    done = true;
    add_law<BilinStyle, false>("bilin", ContactModels::TOMODEM_BILIN);
    add_law<TrilinStyle, true>("trilin", ContactModels::TOMODEM_TRILIN);
}

void register_fixes(LAMMPS& lmp) {
    auto& styles = *(lmp.modify->*member(FixMap()));
    styles["tomodem/planes"] = &make_fix<FixPlanes>;
    styles["tomodem/integrate"] = &make_fix<FixIntegrate>;
    styles["tomodem/surface"] = &make_fix<FixSurface>;
    styles["tomodem/lateral"] = &make_fix<FixLateralBox>;
    styles["tomodem/contact"] = &make_fix<FixContact>;
    styles["tomodem/rebuild"] = &make_fix<FixRebuild>;
    styles["tomodem/norton"] = &make_fix<FixNorton>;
    styles["tomodem/watch"] = &make_fix<FixWatch>;
}

}  // namespace tomodem::plugin
