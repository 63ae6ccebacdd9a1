#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/packing/packing_file.hpp"
#include "tools/render/appearance.hpp"
#include "tools/render/cut.hpp"
#include "tools/render/picture.hpp"
#include "tools/render/quantity.hpp"

/// What a picture shows of a run, and the direction of view.
namespace tomodem::render {

struct SubjectOptions {
    std::string colour = "phase";                         ///< phase, object, none, or the name of a Quantity
    std::optional<std::pair<double, double>> range = {};  ///< of that quantity, in the file's unit
    std::optional<std::int32_t> only_species = {};        ///< label of the only phase shown
    CutPlane cut = {};                                    ///< goes with the material
    std::optional<int> slice = {};                        ///< axis across which a layer of one diameter is shown alone
    double slice_place = 0.5;                             ///< from the lower to the upper end of the sample
    std::string arrows = {};                              ///< vector shown in the slice
    bool objects = false, pores = false;                  ///< their surfaces in the translucent skin of the sample
    double opacity = 0.18;                                ///< of that skin
    double probe_radius = 0.0;                            ///< of those surfaces [mm]; 0: one diameter
    double lid_radius = 0.0;                              ///< of pores with a mouth [mm]; 0: closed ones only
    std::optional<int> press = {};                        ///< axis across which the press planes are shown
    bool outline = true;                                  ///< thin box around the first frame
    std::map<std::int32_t, std::string> names = {};       ///< of the phases
};

/// Smallest axis-parallel box that holds the spheres of this radius. @throws InvalidInput without centres
Box bounds(const std::vector<Vec3>& centres, double radius);

/// Box around the first and the last frame and those of the largest and the smallest strain, so that all pictures of a
/// run have the same scale and place.
Box bounds_of_run(const RunReader& run);

/// Looking at the open side of the cut, or straight at the slice, everything within `region` in the picture.
View view_of(const Box& region, Cut cut, std::optional<int> slice = {});

class Subject {
 public:
    /// Reads the frames once to find what is the same in all their pictures: colours of values, length of arrows.
    /// @param frames  that will be drawn
    /// @throws InvalidInput if the run does not have what is to be shown
    Subject(const RunReader& run, SubjectOptions options, const std::vector<std::size_t>& frames);

    /// Everything but its size and background.
    /// @throws InvalidInput if nothing is left to show
    Picture picture(std::size_t frame) const;

    /// Of the values that are coloured, where they are.
    const std::optional<ColourRange>& range() const { return range_; }
    const std::string& unit() const { return unit_; }

 private:
    void find_range(const std::vector<std::size_t>& frames);
    void find_arrow_length(const std::vector<std::size_t>& frames);
    double place_of_cut(const std::vector<Vec3>& positions) const;
    std::vector<std::size_t> particles_shown(const std::vector<Vec3>& positions) const;
    std::vector<Rgb> colours_of_particles(std::size_t frame) const;
    void add_particles(std::size_t frame, const std::vector<Vec3>& positions, Picture& picture) const;
    void add_surfaces(const std::vector<Vec3>& positions, Picture& picture) const;
    void add_legend(Picture& picture, const std::vector<std::size_t>& shown) const;

    const RunReader& run_;
    SubjectOptions options_;
    Box all_, first_;
    std::optional<Quantity> quantity_;
    std::optional<ColourRange> range_;
    std::string unit_;
    double arrow_unit_ = 0.0;  ///< mm in the picture for a vector of length one
    double arrow_key_ = 0.0;   ///< length of the vector that the key shows
};

}  // namespace tomodem::render
