#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/packing/packing.hpp"
#include "tools/render/picture.hpp"

/// How things look: their colours, and the legend that explains them.
namespace tomodem::render {

inline constexpr Rgb skin_colour{203, 208, 214}, pore_colour{61, 61, 143}, mesh_colour{213, 94, 0};

/// Colours that people with any kind of colour vision can distinguish (Okabe & Ito, Color Universal Design, 2008). The
/// phase with most particles is light grey, the others follow in the order of their labels.
std::map<std::int32_t, Rgb> phase_colours(const Packing& packing);

/// A colour of its own for neighbouring numbers; the same number has the same colour in every picture.
Rgb object_colour(std::int32_t object);

/// One entry for each phase (or the only one) with its share of the particles.
/// @param names  others are "label 3"
std::vector<LegendEntry> phase_legend(const Packing& packing, const std::map<std::int32_t, std::string>& names,
                                      std::optional<std::int32_t> only_species);

/// The values at the ends of a colour scale, in the unit of the file.
struct ColourRange {
    double low = 0.0, high = 1.0;
    ColourMap map = ColourMap::sequential;
    bool lower_values = false, higher_values = false;  ///< some lie beyond
};

/// Finds the range that suits the values of several frames, given one frame after the other.
///
/// Each frame's range leaves out the smallest and the largest hundredth of its values, so that a few outliers do not
/// use up the colours; the result spans the ranges of all frames. A range around zero is made symmetric.
class RangeFinder {
 public:
    /// Values that are not a number are left out.
    void add(std::vector<double> values);
    /// Nothing if no frame has a value.
    /// @param ends  to use instead of those found
    std::optional<ColourRange> range(const std::optional<std::pair<double, double>>& ends) const;

 private:
    double low_ = 0.0, high_ = 0.0;  ///< without the outliers
    double min_ = 0.0, max_ = 0.0;   ///< of all values
    bool any_ = false;
};

/// Grey where there is no value.
std::vector<Rgb> value_colours(const std::vector<double>& values, const ColourRange& range);

/// With a unit in which the numbers are short: MPa instead of Pa.
ColourBar colour_bar_of(const ColourRange& range, const std::string& title, const std::string& unit);

/// "2.3 mm": three significant digits, in a unit in which the number is short.
std::string value_text(double value, const std::string& unit);

}  // namespace tomodem::render
