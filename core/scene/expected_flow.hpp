#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

/// What the calibration says of the flow stress of a phase that is given by norton = { K, M }.
struct ExpectedFlow {
    std::string phase;
    std::int32_t label = 0;
    double stress = 0;  ///< K rate^M at the highest rate [Pa]
    /// |flow stress / (K rate^M) - 1| to expect within the window, 19 times of 20: root of the sum of squares of the
    /// four below, which have nothing to do with each other.
    double error = 0;
    double packings = 0;  ///< twice the spread over packings (NORTON, TRILIN: with the misfit of the law)
    double rates = 0;     ///< BILIN: how far the master curve is from K rate^M over the rates
    double size = 0;      ///< how the stress changes with the number of particles
    double time_step = 0;
    std::array<double, 2> rate{0, 0};    ///< [1/s] for which the constants hold
    std::array<double, 2> strain{0, 0};  ///< |true strain|
    std::vector<std::string> outside;    ///< of what the table was measured on, in words
};

/// Largest |strain| of a scene in each direction; none: the scene has no load in it.
struct Loads {
    std::optional<double> compression, tension;
};
Loads loads_of(const Scene& scene);

/// The larger of the errors of the directions that are loaded; what was not measured goes to `outside`.
double error_of(const DirectedErrors& table, const Loads& loads, ExpectedFlow& found);

/// A number that was computed is outside of a range only if it is so by more than rounding.
inline bool below(double value, double limit) {
    return value < limit * (1 - 1e-6);
}

/// One for each phase of the model that is given by norton.
///
/// Every error is that of one phase alone in a dense sample: what phases do to each other, pores and thin parts are not
/// in it (docs/calibration.md).
std::vector<ExpectedFlow> expected_flows(const Scene& scene, std::int64_t particles, const Model& model);

}  // namespace tomodem
