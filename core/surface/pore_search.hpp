#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/surface/alpha_surface.hpp"

/// Pores of a packing, found in three ways; only the result of the first needs no check by eye (docs/measures.md).
namespace tomodem {

struct Pore {
    Body body;                           ///< of the void; its particles are those around it
    double mouth = 0.0;                  ///< area of the lid over it [mm^2]; 0: closed
    std::vector<std::int32_t> around{};  ///< the centres around it, increasing

    /// Surface of the ball of the same volume over that of the pore, mouth included; 1 for a ball. Both are taken at
    /// the envelope of the centres, without its roughness. @see Wadell, J. Geol. 40 (1932) 443
    double sphericity() const;
};

struct PoreSearch {
    double probe_radius = 0.0;  ///< [mm]: a pore is where a ball of this radius fits between the centres
    double seed_radius = 0.0;   ///< [mm], for the corrected volumes
    /// [mm]: a ball of this radius rolls over the sample from outside, and what it cannot enter is under a lid; 0: no
    /// lids, and what has a way out is no pore.
    double lid_radius = 0.0;
    /// The lid is nearly the convex hull, of a structure that is open (filling.hpp): its struts are too thin for the
    /// layer that is subtracted at the wall of a pore, so the pores with a mouth have what the solid leaves of the
    /// hull.
    bool open_structure = false;
    std::function<void(double)> progress = {};  ///< from 0 to 1
};

struct Pores {
    std::vector<Pore> pores;  ///< largest first
    SurfacePart surface;      ///< oriented out of the pores
    double solid = 0.0;       ///< volume of the particles with their shares of the gaps [mm^3]; 0: not known
    double volume() const;    ///< [mm^3]
    double corrected_volume() const;
    double mouth() const;  ///< [mm^2]
    /// Leaves out pores smaller than `min_volume` [mm^3].
    void leave_out_below(double min_volume);
};

/// Default radius [mm] of the ball that rolls over the outside, for all frames of a run.
///
/// Half of the shortest edge of the box around the centres, so that it enters what is as wide as the sample itself. Of
/// an open structure, into which such a ball falls as its gaps move, ten times the longest edge: nearly the convex
/// hull.
/// @param centres  of the first frame
double default_lid_radius(std::span<const Vec3> centres, bool open_structure);

/// Numbers that stay with a pore from frame to frame: a pore takes that of the earlier pore with which it shares the
/// largest number of centres, if that is at least a fifth of the smaller set; the larger pores choose first, and a new
/// one takes the next free number.
/// @param before, numbers_before  of the frame before, each number once
/// @param next                    the next free number; is raised
std::vector<std::int64_t> lasting_numbers(const Pores& now, const Pores& before,
                                          const std::vector<std::int64_t>& numbers_before, std::int64_t& next);

/// Voids of the alpha shape that no way leads out of, those with a mouth under a lid.
///
/// The lid is the surface that the large ball rolls on. It is laid out with points close enough that the probe cannot
/// pass, in two layers, so that dents too shallow for a probe below the lid are not voids: the roughness of the outside
/// does not count. A pore so wide that the large ball fits into it, and with a mouth, is a dent of the outside.
///
/// The corrected volume goes to the edge of the material at the walls and to the lid at the mouth.
/// @throws InvalidInput as alpha_surface; if the lid's radius is less than twice the probe's
/// @note   twice the time of alpha_surface with lids
Pores find_pores(std::span<const Vec3> centres, const PoreSearch& search);

/// The volume [mm^3] that a large probe cannot enter less that which a small one cannot: the thesis' way to the volume
/// of the pores, without its reference (section 16.1). The roughness of the outside is in it.
/// @throws InvalidInput as alpha_surface; if the large probe is not larger
double probe_difference(std::span<const Vec3> centres, double small_probe, double large_probe);

/// n_i = - sum of the vectors to the neighbours within `reach` [mm]: long at a free surface, pointing out.
/// @see thesis section 9.3
std::vector<Vec3> outward_vectors(std::span<const Vec3> centres, double reach, int threads = 1);

/// The thesis' way to see pores (section 16.1): the particles whose outward vector is longer than `min_outward`, less
/// those of the exterior, wrapped by an alpha shape. The volume is all that its outer surfaces enclose.
///
/// The thesis took the particles of the exterior out by hand; here they are those within a probe's diameter of a centre
/// that the large ball touches from outside (PoreSearch::lid_radius).
/// @param outward      [mm], one a centre
/// @param min_outward  N_mag [mm]
/// @throws InvalidInput as alpha_surface, for the sample; no pore: an empty result
Pores pores_by_outward_vectors(std::span<const Vec3> centres, std::span<const Vec3> outward, double min_outward,
                               const PoreSearch& search);

}  // namespace tomodem
