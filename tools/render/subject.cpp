#include "tools/render/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/base/error.hpp"
#include "core/surface/filling.hpp"
#include "core/surface/reconstruction.hpp"

namespace tomodem::render {
namespace {

/// Length in the picture of an arrow that is longer than all but a few, in diameters.
constexpr double long_arrow = 2.5;

std::string strain_text(double strain) {
    const std::string text = fmt::format("{:.3f}", std::abs(strain));
    return fmt::format("true strain {}{}", strain < 0 && text != "0.000" ? "−" : "", text);
}

/// Slabs that touch the outermost particles, cut like the sample.
/// @param place  of the cut now [mm]
std::vector<Box> press_planes(const Box& sample, int axis, Cut cut, double place) {
    Box lower = sample;
    const double thickness = 0.01 * sample.edges.maxCoeff();
    lower.origin -= 0.05 * sample.edges;
    lower.edges *= 1.1;
    if (cut == Cut::x && axis != 0) lower.edges.x() = place - lower.origin.x();
    if (cut == Cut::y && axis != 1) {
        lower.edges.y() -= place - lower.origin.y();
        lower.origin.y() = place;
    }
    lower.edges[axis] = thickness;
    lower.origin[axis] = sample.origin[axis] - thickness;
    Box upper = lower;
    upper.origin[axis] = sample.origin[axis] + sample.edges[axis];
    return {lower, upper};
}

/// 1, 2 or 5 times a power of ten, at most `limit`.
double round_below(double limit) {
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    for (const double digit : {5.0, 2.0})
        if (digit * power <= limit) return digit * power;
    return power;
}

Surface coloured(const Reconstruction& bodies, const std::vector<Rgb>& of_triangle, double opacity) {
    Surface surface{bodies.mesh, std::vector<Rgb>(bodies.mesh.vertices.size()), opacity};
    for (std::size_t t = 0; t < bodies.mesh.triangles.size(); ++t)
        for (const auto vertex : bodies.mesh.triangles[t])
            surface.colours[static_cast<std::size_t>(vertex)] = of_triangle[t];
    return surface;
}

Surface coloured(const Reconstruction& bodies, Rgb colour, double opacity) {
    return coloured(bodies, std::vector<Rgb>(bodies.mesh.triangles.size(), colour), opacity);
}

struct Extent {
    double mean = 0.0, deviation = 0.0;
};

Extent extent_along(const std::vector<Vec3>& positions, int axis) {
    double mean = 0.0, square = 0.0;
    for (const Vec3& position : positions) mean += position[axis];
    mean /= static_cast<double>(positions.size());
    for (const Vec3& position : positions) square += (position[axis] - mean) * (position[axis] - mean);
    return {mean, std::sqrt(square / static_cast<double>(positions.size()))};
}

/// Darker the deeper a sphere lies below the faces of the sample and below the cut, as a hole is darker than its rim:
/// there are no shadows, and a pore that is cut open would look as the matter around it.
void darken_what_is_deep(const Box& sample, int axis, double place, double diameter, Picture& picture) {
    constexpr double seen_anyway = 1.0, darkest = 0.35, a_diameter = 0.25;
    for (std::size_t k = 0; k < picture.centres.size(); ++k) {
        const Vec3 below = picture.centres[k] - sample.origin;
        const double depth =
            std::min({below.minCoeff(), (sample.edges - below).minCoeff(), std::abs(picture.centres[k][axis] - place)});
        const double light = std::clamp(1.0 - a_diameter * (depth / diameter - seen_anyway), darkest, 1.0);
        Rgb& colour = picture.colours[k];
        for (std::uint8_t* part : {&colour.red, &colour.green, &colour.blue})
            *part = static_cast<std::uint8_t>(std::lround(light * *part));
    }
}

std::string counted(std::size_t count, const std::string& thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// Whether few particles stretch the box around all of them: some have come loose and fly away.
bool has_outliers(const std::vector<Vec3>& centres, const Box& all) {
    constexpr double share = 0.01, stretched = 1.5;
    std::vector<double> along(centres.size());
    const auto few = static_cast<std::ptrdiff_t>(share * static_cast<double>(centres.size()));
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(centres.begin(), centres.end(), along.begin(), [axis](const Vec3& at) { return at[axis]; });
        std::nth_element(along.begin(), along.begin() + few, along.end());
        const double low = along[few];
        std::nth_element(along.begin(), along.end() - 1 - few, along.end());
        if (all.edges[axis] > stretched * (along[along.size() - 1 - few] - low)) return true;
    }
    return false;
}

}  // namespace

Box bounds(const std::vector<Vec3>& centres, double radius) {
    if (centres.empty()) throw InvalidInput("there is nothing to draw: no particles");
    const auto around = [radius](const std::vector<Vec3>& points) {
        Vec3 low = points.front(), high = points.front();
        for (const Vec3& point : points) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        }
        return Box{.origin = low.array() - radius, .edges = (high - low).array() + 2 * radius};
    };
    const Box all = around(centres);
    if (radius == 0 || !has_outliers(centres, all)) return all;
    return around(centres_of(centres, without_loose(centres, radius)));
}

Box bounds_of_run(const RunReader& run) {
    const double radius = run.packing().seed_radius;
    std::set<std::size_t> frames{run.frame_count() - 1};
    if (const auto strain = run.observables().find("strain"); strain != run.observables().end()) {
        std::vector<double> strains;
        for (std::size_t k = 0; k < run.frame_count(); ++k)
            strains.push_back(value_at(strain->second, run.frame_time(k)));
        const auto [smallest, largest] = std::minmax_element(strains.begin(), strains.end());
        frames.insert({std::size_t(smallest - strains.begin()), std::size_t(largest - strains.begin())});
    }
    frames.erase(0);
    Box all = bounds(run.packing().position, radius);
    for (const std::size_t frame : frames) {
        const Box box = bounds(run.frame(frame).position, radius);
        const Vec3 low = all.origin.cwiseMin(box.origin);
        const Vec3 high = (all.origin + all.edges).cwiseMax(box.origin + box.edges);
        all = {.origin = low, .edges = high - low};
    }
    return all;
}

View view_of(const Box& region, Cut cut, std::optional<int> slice) {
    Vec3 direction = cut == Cut::x ? Vec3(1.0, -0.55, 0.5) : Vec3(0.55, -1.0, 0.5);
    if (slice) direction = *slice == 1 ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::Unit(*slice));
    return {.towards_camera = direction, .low = region.origin, .high = region.origin + region.edges};
}

Subject::Subject(const RunReader& run, SubjectOptions options, const std::vector<std::size_t>& frames)
    : run_(run), options_(std::move(options)), all_(bounds_of_run(run)) {
    const Packing& packing = run.packing();
    first_ = bounds(packing.position, packing.seed_radius);
    if (options_.colour == "object" && packing.object.empty())
        throw InvalidInput("the packing has no objects; make it with vol2pack --objects, or colour by phase");
    if (options_.only_species) {
        const std::set<std::int32_t> labels(packing.species.begin(), packing.species.end());
        if (!labels.contains(*options_.only_species))
            throw InvalidInput(fmt::format("no particle has label {}; the packing has {}", *options_.only_species,
                                           fmt::join(labels, ", ")));
    }
    if (options_.colour != "phase" && options_.colour != "object" && options_.colour != "none") find_range(frames);
    if (!options_.arrows.empty()) find_arrow_length(frames);
}

void Subject::find_range(const std::vector<std::size_t>& frames) {
    quantity_.emplace(run_, options_.colour);
    unit_ = quantity_->unit();
    RangeFinder finder;
    for (const std::size_t frame : frames) {
        std::vector<double> values = quantity_->values(frame);
        if (options_.only_species)
            for (std::size_t k = 0; k < values.size(); ++k)
                if (run_.packing().species[k] != *options_.only_species) values[k] = std::nan("");
        finder.add(std::move(values));
    }
    range_ = finder.range(options_.range);
    if (!range_)
        throw InvalidInput(fmt::format("'{}' has no value in {}; choose another frame", options_.colour,
                                       frames.size() == 1 ? fmt::format("frame {}", frames.front()) : "these frames"));
}

void Subject::find_arrow_length(const std::vector<std::size_t>& frames) {
    double longest = 0.0;
    for (const std::size_t frame : frames) {
        std::vector<double> lengths;
        for (const Vec3& vector : vectors(run_, options_.arrows, frame))
            if (vector.allFinite()) lengths.push_back(vector.norm());
        if (lengths.empty()) continue;
        const auto place =
            lengths.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(lengths.size() - 1));
        std::nth_element(lengths.begin(), place, lengths.end());
        longest = std::max(longest, *place);
    }
    if (longest == 0.0)
        throw InvalidInput(fmt::format("'{}' is zero everywhere in {}; choose another frame", options_.arrows,
                                       frames.size() == 1 ? fmt::format("frame {}", frames.front()) : "these frames"));
    arrow_unit_ = long_arrow * 2 * run_.packing().seed_radius / longest;
    arrow_key_ = round_below(longest);
}

/// The plane moves and stretches with the mean and the spread of all particles, so that it goes through the same
/// material in every frame of a uniform deformation.
double Subject::place_of_cut(const std::vector<Vec3>& positions) const {
    const int axis = options_.cut.axis();
    const Extent first = extent_along(run_.packing().position, axis), now = extent_along(positions, axis);
    const double stretch = first.deviation > 0 ? now.deviation / first.deviation : 1.0;
    return now.mean + stretch * (options_.cut.place - first.mean);
}

std::vector<std::size_t> Subject::particles_shown(const std::vector<Vec3>& positions) const {
    const Packing& packing = run_.packing();
    const double cut_place = place_of_cut(positions);
    double place = 0.0;
    if (options_.slice) {
        const Box now = bounds(positions, packing.seed_radius);
        place = now.origin[*options_.slice] + options_.slice_place * now.edges[*options_.slice];
    }
    std::vector<std::size_t> shown;
    for (std::size_t k = 0; k < packing.size(); ++k) {
        if (options_.only_species && packing.species[k] != *options_.only_species) continue;
        if (options_.cut.cut == Cut::x && positions[k].x() > cut_place) continue;
        if (options_.cut.cut == Cut::y && positions[k].y() < cut_place) continue;
        if (options_.slice && std::abs(positions[k][*options_.slice] - place) > packing.seed_radius) continue;
        shown.push_back(k);
    }
    if (shown.empty())
        throw InvalidInput(
            fmt::format("there is nothing to draw: the {} leaves no particle", options_.slice ? "slice" : "cut"));
    return shown;
}

std::vector<Rgb> Subject::colours_of_particles(std::size_t frame) const {
    const Packing& packing = run_.packing();
    if (quantity_) return value_colours(quantity_->values(frame), *range_);
    std::vector<Rgb> colours(packing.size(), skin_colour);
    if (options_.colour == "phase") {
        const auto of_phase = phase_colours(packing);
        for (std::size_t k = 0; k < colours.size(); ++k) colours[k] = of_phase.at(packing.species[k]);
    }
    if (options_.colour == "object")
        for (std::size_t k = 0; k < colours.size(); ++k) colours[k] = object_colour(packing.object[k]);
    return colours;
}

void Subject::add_legend(Picture& picture, const std::vector<std::size_t>& shown) const {
    if (options_.colour == "object") {
        std::set<std::int32_t> objects;
        for (const std::size_t k : shown)
            if (run_.packing().object[k] > 0) objects.insert(run_.packing().object[k]);
        picture.caption = counted(objects.size(), "object");
    }
    if (options_.colour == "phase")
        picture.legend = phase_legend(run_.packing(), options_.names, options_.only_species);
    if (quantity_) picture.bar = colour_bar_of(*range_, quantity_->title(), unit_);
}

void Subject::add_particles(std::size_t frame, const std::vector<Vec3>& positions, Picture& picture) const {
    const std::vector<Rgb> colours = colours_of_particles(frame);
    const std::vector<std::size_t> shown = particles_shown(positions);
    picture.radius = run_.packing().seed_radius;
    for (const std::size_t k : shown) {
        picture.centres.push_back(positions[k]);
        picture.colours.push_back(colours[k]);
    }
    if (options_.cut.cut != Cut::none && !quantity_)
        darken_what_is_deep(bounds(positions, picture.radius), options_.cut.axis(), place_of_cut(positions),
                            2 * picture.radius, picture);
    add_legend(picture, shown);
    if (options_.arrows.empty()) return;
    const std::vector<Vec3> all = vectors(run_, options_.arrows, frame);
    for (const std::size_t k : shown)
        if (all[k].allFinite()) picture.arrows.push_back({positions[k], positions[k] + arrow_unit_ * all[k]});
    std::string unit;
    for (const ParticleField& field : run_.fields())
        if (field.name == options_.arrows) unit = field.unit;
    picture.arrow_key = arrow_unit_ * arrow_key_;
    picture.arrow_key_text = fmt::format("{} {}", options_.arrows, value_text(arrow_key_, unit));
}

void Subject::add_surfaces(const std::vector<Vec3>& positions, Picture& picture) const {
    Packing packing = run_.packing();
    packing.position = positions;
    ReconstructionOptions wanted;
    wanted.probe_radius = options_.probe_radius > 0 ? options_.probe_radius : default_probe_radius(packing.seed_radius);
    picture.legend.push_back({skin_colour, "sample"});
    if (options_.objects) {
        wanted.bodies = Bodies::objects;
        const Reconstruction objects = reconstruct(packing, wanted);
        std::vector<Rgb> colours;
        for (const auto object : objects.object_of_triangle) colours.push_back(object_colour(object));
        picture.surfaces.push_back(coloured(objects, colours, 1.0));
        const std::set<std::int32_t> numbers(objects.object_of_triangle.begin(), objects.object_of_triangle.end());
        if (!numbers.empty())
            picture.legend.push_back({object_colour(*numbers.begin()), counted(numbers.size(), "object")});
    }
    if (options_.pores) {
        wanted.bodies = Bodies::pores;
        wanted.lid_radius = options_.lid_radius;
        const Reconstruction pores = reconstruct(packing, wanted);
        picture.surfaces.push_back(coloured(pores, pore_colour, 1.0));
        picture.legend.push_back(
            {pore_colour, counted(pores.rows.size(), options_.lid_radius > 0 ? "pore" : "closed pore")});
    }
    wanted.bodies = Bodies::parts;
    picture.surfaces.push_back(coloured(reconstruct(packing, wanted), skin_colour, options_.opacity));
}

Picture Subject::picture(std::size_t frame) const {
    const Frame now = run_.frame(frame);
    Picture picture;
    picture.view = view_of(all_, options_.cut.cut, options_.slice);
    if (options_.objects || options_.pores)
        add_surfaces(now.position, picture);
    else
        add_particles(frame, now.position, picture);
    if (options_.outline) picture.outline = first_;
    if (options_.press)
        picture.plates = press_planes(bounds(now.position, run_.packing().seed_radius), *options_.press,
                                      options_.cut.cut, place_of_cut(now.position));
    if (const auto strain = run_.observables().find("strain"); strain != run_.observables().end()) {
        if (!picture.caption.empty()) picture.caption += ", ";
        picture.caption += strain_text(value_at(strain->second, now.time));
    }
    return picture;
}

}  // namespace tomodem::render
