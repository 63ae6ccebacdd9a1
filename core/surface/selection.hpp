#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem {

/// Particles of a phase, of an object, or of both; without either, all.
struct Selection {
    std::optional<std::int64_t> species = {}, object = {};
};

/// Centres [mm] of the particles of the selection, in the order of the packing.
/// @throws InvalidInput naming what there is, if there is no such species or object
std::vector<Vec3> selected_centres(const Packing& packing, const Selection& selection);

}  // namespace tomodem
