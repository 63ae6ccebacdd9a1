#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/packing_file.hpp"
#include "tools/render/picture.hpp"

/// How a packing looks: what is shown of it, in which colours, from where.
namespace tomodem {

enum class ColourBy { phase, object, none };
enum class Cut { none, x, y };

/// Colours that people with any kind of colour vision tell apart (Okabe & Ito, Color Universal Design, 2008). The phase
/// with most particles is light grey, the others follow in the order of their labels.
std::map<std::int32_t, Rgb> phase_colours(const Packing& packing);

/// A colour of its own for neighbouring numbers; the same number has the same colour in every picture.
Rgb object_colour(std::int32_t object);

/// Smallest axis-parallel box that holds the spheres of this radius. @throws InvalidInput without centres
Box bounds(const std::vector<Vec3>& centres, double radius);

/// Box around the first and the last frame, so that all pictures of one run have the same scale and place.
Box bounds_of_run(const RunReader& run);

/// Looking at the open side of the cut, everything within `region` in the picture.
View view_of(const Box& region, Cut cut);

struct Appearance {
    ColourBy colour = ColourBy::phase;
    Cut cut = Cut::none;                        ///< the half towards the camera is taken away
    std::optional<std::int32_t> only_species;   ///< label of the only phase shown
    std::map<std::int32_t, std::string> names;  ///< of the phases; others are "label 3"
};

/// Fills centres, colours, radius and legend (or a caption of objects) of a picture from one frame.
///
/// @param positions  in the order of the packing's ids
/// @param middle     where a cut goes through
/// @throws InvalidInput if nothing is left to show, or objects are asked for and the packing has none
void show(const Packing& packing, const std::vector<Vec3>& positions, const Vec3& middle, const Appearance& appearance,
          Picture& picture);

}  // namespace tomodem
