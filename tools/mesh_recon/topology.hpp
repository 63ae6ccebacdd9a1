#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/alpha_surface.hpp"

/// Parts, handles and pores of the alpha shape through the frames of a run, and what happens to them.
namespace tomodem::mesh_recon {

/// Smaller parts and pores are counted, but not followed from frame to frame.
struct MinSizes {
    std::int64_t particles = 20;  ///< of a part
    double pore = 4.0;            ///< volume of a pore, in volumes of a particle with its share of the gaps
};

/// The alpha shape of a frame without its surface.
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

FrameTopology frame_topology(AlphaSurface surface, const MinSizes& min);

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

/// A part continues in the part that shares the largest number of particles with it, a pore in the pore that shares the
/// largest number of the particles around it (at least 0.5 and 0.3 of the smaller set), seen from either frame; a pore
/// without such a partner continues in the pore that takes its place. Several that continue in one have merged. A pore
/// that ends, or begins, is open to the outside if half of the particles around it lie at the outside.
///
/// @param before, after      the same particles in the same order
/// @param positions_before, positions_after  of these particles [mm]
/// @param reach              twice the probe radius [mm]: centres that may be joined in a part
/// @return  by kind, then by the numbers in the frame
std::vector<Event> events_between(const FrameTopology& before, const FrameTopology& after,
                                  std::span<const Vec3> positions_before, std::span<const Vec3> positions_after,
                                  double reach);

}  // namespace tomodem::mesh_recon
