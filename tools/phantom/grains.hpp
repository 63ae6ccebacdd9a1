#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/phantom/spheres.hpp"

namespace tomodem::phantom {

/// What fixes the inclusions: two of the three.
struct InclusionRequest {
    std::optional<double> fraction;
    std::optional<std::int64_t> count;
    std::optional<std::array<double, 2>> diameter;  ///< smallest and largest [mm], uniform between them
};

/// Spheres, not yet placed. With a fraction and a range of diameters their number is the one that comes nearest to the
/// fraction, and all are then scaled by one factor (near 1) to meet it exactly.
/// @throws InvalidInput if the fraction cannot be met
std::vector<Grain> draw_inclusions(const InclusionRequest& request, double volume, Random& random);

/// "60um" or "40um:80um" as diameters [mm]; nothing where the text is empty. @throws WrongUsage naming --diameter
std::optional<std::array<double, 2>> diameter_range(const std::string& text);

/// Puts spheres into a box so that they may overlap: two centres are never nearer than (1 - overlap) times the sum of
/// the radii. The denser, the more of them touch.
/// @throws InvalidInput as place_without_overlap
std::vector<Grain> place_touching(std::vector<Grain> spheres, const Vec3& edges, double overlap, Random& random,
                                  Reporter& reporter = silent_reporter());

struct PoreRequest {
    double porosity = 0.0;
    double median_diameter = 0.0;  ///< mm, of the sphere of equal volume
    double spread = 0.0;           ///< standard deviation of ln(diameter); the tails are cut at 2.5 of them
    double cluster_share = 0.0;    ///< part of the pores (by number) that are clusters of 3 to 5 overlapping spheres
};

/// Pores, not yet placed; their volumes meet the porosity as draw_inclusions does.
std::vector<Grain> draw_pores(const PoreRequest& request, double volume, Random& random);

}  // namespace tomodem::phantom
