#pragma once
#include <cstdint>
#include <vector>

#include "core/scene/model.hpp"
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
    double time_step = 0.0;      ///< s; 0: that of the model, where a simulation is given one
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

/// The time of a load, by the steps of a simulation: segments have time steps of their own.
struct LoadClock {
    double time = 0;        ///< s at `step`
    std::int64_t step = 0;  ///< where steps of this length begin
    double time_step = 0;   ///< s; 0: the clock stands still

    double at(std::int64_t now) const { return time + time_step * static_cast<double>(now - step); }
    /// The clock whose steps have that length from `now` on. Where they have it already it is this one, so that times
    /// are not sums of roundings.
    LoadClock from(std::int64_t now, double length) const {
        return length == time_step ? *this : LoadClock{at(now), now, length};
    }
};

/// Clocks of the segments, one each, from time 0 and step 0 at the beginning of the first.
std::vector<LoadClock> clocks_of(const std::vector<LoadSegment>& segments);

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
/// Quasi-static: each segment has a time step of its own, such that no step has more strain than
/// Model::strain_per_step, and a polynomial whose rates differ by more than a factor of two becomes several segments:
/// from its highest rate to a half, to a quarter, to an eighth, and what is below.
///
/// @param begin  where an earlier run ended: the strains of the scene count from there
std::vector<LoadSegment> load_path(const Scene& scene, const Model& model, const LoadBegin& begin = {});

}  // namespace tomodem
