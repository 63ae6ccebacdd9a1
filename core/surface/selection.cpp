#include "core/surface/selection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/base/error.hpp"

namespace tomodem {

std::vector<Vec3> selected_centres(const Packing& packing, const Selection& selection) {
    if (selection.object && packing.object.empty())
        throw InvalidInput(
            fmt::format("no object {} in the sample: its particles carry no object numbers; set 'objects = true' "
                        "for the phase in the scene, or select by species",
                        *selection.object));
    std::vector<Vec3> centres;
    for (std::size_t i = 0; i < packing.size(); ++i) {
        if (selection.species && packing.species[i] != *selection.species) continue;
        if (selection.object && packing.object[i] != *selection.object) continue;
        centres.push_back(packing.position[i]);
    }
    if (!centres.empty()) return centres;
    if (selection.species) {
        const std::set<std::int32_t> labels(packing.species.begin(), packing.species.end());
        throw InvalidInput(fmt::format("no particle of species {} in the sample; it has {}", *selection.species,
                                       fmt::join(labels, ", ")));
    }
    if (selection.object)
        throw InvalidInput(fmt::format("no object {} in the sample; its objects are numbered 1 to {}",
                                       *selection.object,
                                       *std::max_element(packing.object.begin(), packing.object.end())));
    throw InvalidInput("the sample has no particles");
}

}  // namespace tomodem
