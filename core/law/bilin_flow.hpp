#pragma once

/// What sets BILIN's flow stress: sigma = k_rep / (2 r_s) g(chi), chi = rate t0^2 / time_step (docs/method.md).
namespace tomodem::law {

/// Above, the packing collapses.
inline constexpr double greatest_chi = 41;

/// g(chi) [-], interpolated in a table of measured values, constant below it.
/// @throws InvalidInput above the table (chi > greatest_chi)
double bilin_master_curve(double chi);

/// Strain-rate sensitivity over the decade of rates up to the one of `chi`: log10(g(chi) / g(chi/10)).
double bilin_rate_sensitivity(double chi);

/// The chi whose sensitivity is M. On the plateau (M below that of chi = 0.02) it is 0: any small chi serves.
///
/// The curve's steepest decade has M = 0.47 (chi about 1.3): values up to 0.5 are given that chi.
/// @throws InvalidInput for M above 0.5
double bilin_chi_for(double rate_sensitivity);

/// A natural period shorter than this many time steps loses particles or falsifies the stress (method: stability).
inline constexpr double least_steps_per_period = 20.0;

}  // namespace tomodem::law
