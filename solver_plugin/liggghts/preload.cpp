// Preloaded into the stock liggghts executable, this makes its input scripts know model bilin (docs/plain-liggghts.md).
#include "solver_plugin/liggghts/registration.hpp"

namespace {
struct AtLoad {
    AtLoad() { tomodem::plugin::register_laws(); }
} at_load;
}  // namespace
