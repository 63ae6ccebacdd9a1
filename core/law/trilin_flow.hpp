#pragma once
#include <cmath>

/// TRILIN's constants (thesis section 14.1; those that its text lost are in docs/method.md) and its flow stress.
namespace tomodem::law {

/// The time step belongs to the law: at half of it the flow stress is a quarter higher.
inline constexpr double trilin_steps_per_period = 10.0;
inline constexpr double trilin_crown_over_seed = 1.4;
inline constexpr double trilin_stiffness_ratio = 3.0;  ///< k_rep / k_att
/// f_att / (k_rep r_s)
inline constexpr double trilin_attraction = 0.141;

/// rate t0 up to which the flow stress is K rate^M; at 0.2 the planes differ by 20 %, at 0.5 the packing bounces off.
inline constexpr double trilin_max_rate = 0.1;

/// A measured flow stress over k_rep / (2 r_s): flow (rate t0)^sensitivity (docs/calibration.md).
struct TrilinFlow {
    double flow = 0;         ///< [-] at rate t0 = 1
    double sensitivity = 0;  ///< M [-]
    double tolerance = 0;    ///< how far a wanted M may be from it

    double at(double rate_times_period) const { return flow * std::pow(rate_times_period, sensitivity); }
};

}  // namespace tomodem::law
