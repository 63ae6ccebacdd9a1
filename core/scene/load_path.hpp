#pragma once
#include <cstdint>
#include <vector>

#include "core/scene/scene.hpp"

/// The loading of a scene in whole time steps.
namespace tomodem {

/// A stretch of the loading with one polynomial of the true strain rate.
///
/// Time counts from the segment's start. Strain is the integral of the rate, in closed form.
struct LoadSegment {
    double strain = 0.0;         ///< at its start [-]
    std::vector<double> rate{};  ///< signed coefficients [1/s, 1/s^2, ...] of the true strain rate in time
    std::int64_t steps = 0;      ///< whole time steps; after the last the strain is the target
    double time_step = 0.0;      ///< s
    bool initiates = false;      ///< a ramp that starts a flow or changes its rate
    bool affine = false;         ///< the particles are accelerated with the flow (Initiation)
    double noise = 0.0;          ///< random velocity given at the start over 2 r_s [1/s]

    double rate_at(double time) const;    ///< signed [1/s]
    double strain_at(double time) const;  ///< [-]
    double end_strain() const;
    /// Number of steps from the start at which the strain is nearest to `strain`, from 0 to `steps`.
    std::int64_t step_at(double strain) const;
    /// Steps of the points of a curve, about `spacing` [-] of strain apart: increasing from above 0, the last is
    /// `steps`.
    std::vector<std::int64_t> curve_steps(double spacing) const;
};

/// Where a load begins.
struct LoadBegin {
    double strain = 0;  ///< of the segments
    double rate = 0;    ///< signed [1/s], of the segment before
};

/// Segments that follow one another: those of the steps, each with a ramp of the rate before it where the scene has an
/// initiation and the direction or the rate changes.
///
/// A step's polynomial is scaled (by less than half a time step over its duration) so that it takes whole time steps.
/// A scene with a duration instead of steps has one segment, of the nominal rate and strain.
///
/// @param begin  where an earlier run ended: the strains of the scene count from there
std::vector<LoadSegment> load_path(const Scene& scene, double time_step, const LoadBegin& begin = {});

}  // namespace tomodem
