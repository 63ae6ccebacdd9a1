#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/alpha_surface.hpp"

/// Parts, handles and pores of the alpha shape through the frames of a run, and what happens to them.
namespace tomodem {

/// What is too small to be followed.
struct LeastSizes {
    std::int64_t particles = 20;  ///< of a part
    double pore = 4.0;            ///< volume of a pore, in volumes of a particle with its share of the gaps
};

/// What remains of a frame's alpha shape when its surface is forgotten.
struct FrameTopology {
    std::int64_t b0 = 0;                                     ///< parts of any size
    std::int64_t b1 = 0;                                     ///< handles
    std::int64_t b2 = 0;                                     ///< pores of any size
    double volume = 0.0;                                     ///< of the solid [mm^3]
    double pore_volume = 0.0;                                ///< of all pores [mm^3]
    std::vector<Body> parts, pores;                          ///< those that are followed, largest first
    std::vector<std::int32_t> part_of_centre;                ///< -1: none that is followed
    std::vector<std::vector<std::int32_t>> centres_of_pore;  ///< around each pore
    std::vector<bool> outside;                               ///< is the centre at the void outside?
};

FrameTopology frame_topology(AlphaSurface surface, const LeastSizes& least);

enum class Change {
    merge,          ///< two parts became one
    split,          ///< a part fell in two
    part_appeared,  ///< a part that is made of no earlier one
    part_vanished,  ///< its particles are in no part
    coalescence,    ///< two pores became one
    pore_split,
    pore_opened,    ///< a pore where there was none
    pore_closed,    ///< a pore is gone, its walls have met
    pore_breached,  ///< a pore found a way outside
    pore_sealed     ///< a dent or an open pore was cut off from the outside
};
const char* name_of(Change change);

/// Happened between one frame and the next.
struct Event {
    Change change;
    Vec3 place = Vec3::Zero();                ///< mm: where the two meet or part; the centre of what is alone
    double volume = 0.0;                      ///< of the smaller of the two, or of what is alone [mm^3]
    std::vector<std::int32_t> before, after;  ///< parts or pores concerned, numbered from 0 in their frames
};

/// A part goes on as the part that shares most particles with it, a pore as the one that shares most of the particles
/// around it (0.5 and 0.3 of the smaller set at least), seen from either frame; a pore without such a partner as the
/// one whose place it takes. Where several go on as one, they merged. Of a pore that goes on as none, and of one that
/// comes from none, half of the particles around it say whether the outside was there.
///
/// @param before, after      the same particles in the same order
/// @param positions_before, positions_after  of these particles [mm]
/// @param reach              twice the probe radius [mm]: centres that may be joined in a part
/// @return  by kind, then by the numbers in the frame
std::vector<Event> events_between(const FrameTopology& before, const FrameTopology& after,
                                  std::span<const Vec3> positions_before, std::span<const Vec3> positions_after,
                                  double reach);

}  // namespace tomodem
