#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "core/packing/packing_file.hpp"
#include "tools/metrics/shapes/ellipsoid.hpp"

namespace tomodem::shapes {

/// One object of a sample and its particles.
struct Object {
    std::int32_t number, species;
    std::vector<std::size_t> members;  ///< indices into the packing
    bool at_boundary = false;          ///< see choose_objects
};

struct ObjectChoice {
    std::size_t min_particles = 20;  ///< at least 4
    bool exclude_boundary = false;
};

struct ChosenObjects {
    std::vector<Object> used;     ///< by number
    std::size_t too_small = 0;    ///< fewer particles than asked for, or all of them in one plane
    std::size_t at_boundary = 0;  ///< of those large enough, where they are left out
};

/// Objects (number > 0) that have a shape to measure.
///
/// An object is at the boundary if one of its centres is less than a particle diameter from a face of the box that was
/// filled, or from the smallest box around all centres (a relaxed sample is not exactly the box that was filled).
/// @throws InvalidInput if the packing has no objects, or none is left
ChosenObjects choose_objects(const Packing& packing, const ObjectChoice& choice);

/// Axis of the load, by the scene that the run holds; z for a sample.
int load_axis(const RunReader& run, const std::filesystem::path& file);

/// Mean and standard deviation over objects.
struct Spread {
    double mean = 0.0;
    std::optional<double> deviation;  ///< none for one object
};
/// Every object counts the same; deviation with n - 1.
Spread plain_spread(std::span<const double> values);
/// An object counts by its weight: deviation^2 = sum w (x - mean)^2 / sum w.
Spread weighted_spread(std::span<const double> values, std::span<const double> weights);

}  // namespace tomodem::shapes
