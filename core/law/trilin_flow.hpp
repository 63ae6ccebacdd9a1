#pragma once
#include <cmath>

/// TRILIN's calibration (thesis section 14.1; the constants that its text lost are in docs/method.md).
namespace tomodem::law {

/// The time step belongs to the law: at half of it the flow stress is a quarter higher.
inline constexpr double trilin_steps_per_period = 10.0;
inline constexpr double trilin_crown_over_seed = 1.4;
inline constexpr double trilin_stiffness_ratio = 3.0;  ///< k_rep / k_att
/// f_att / (k_rep r_s)
inline constexpr double trilin_attraction = 0.141;
inline constexpr double trilin_rate_sensitivity = 0.0714;
/// How far a wanted M may be from TRILIN's own.
inline constexpr double trilin_sensitivity_tolerance = 0.03;

/// rate t0 up to which the flow stress is K rate^M; at 0.2 the planes differ by 20 %, at 0.5 the packing bounces off.
inline constexpr double trilin_greatest_rate = 0.1;

/// Flow stress over k_rep / (2 r_s) at rate * t0: K = 49.1 MPa.s^M for k_rep = 1.42e9 uN/mm, r_s = 0.5 mm, t0 = 1 s.
inline double trilin_flow(double rate_times_period) {
    return 49.1e6 / 1.42e9 * std::pow(rate_times_period, trilin_rate_sensitivity);
}

}  // namespace tomodem::law
