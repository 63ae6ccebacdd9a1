#pragma once
#include <vector>

/// What sets BILIN's flow stress: sigma = k_rep / (2 r_s) g(chi), chi = rate t0^2 / time_step (docs/method.md).
namespace tomodem::law {

/// Above, the packing collapses.
inline constexpr double max_chi = 41;

/// A natural period shorter than this many time steps loses particles or falsifies the stress (method: stability).
inline constexpr double min_steps_per_period = 20.0;

/// The master curve g(chi), from a table of measured values (docs/calibration.md).
struct BilinFlow {
    std::vector<double> chi;     ///< two or more, increasing
    std::vector<double> flow;    ///< g [-], as many, above 0
    double max_sensitivity = 0;  ///< M up to which the steepest decade is taken for it

    /// g(chi), straight between the values in a log-log plot, constant below the first.
    /// @throws InvalidInput above the last
    double at(double chi) const;

    /// Strain-rate sensitivity over the decade of rates up to the one of `chi`: log10(g(chi) / g(chi/10)).
    double sensitivity(double chi) const;

    /// The chi whose sensitivity is M. On the plateau (M below that of twice the lowest chi) it is 0: any small chi
    /// serves. Values between that of the steepest decade and the largest sensitivity are given the steepest decade.
    /// @throws InvalidInput for a larger M, naming the law that can
    double chi_for(double rate_sensitivity) const;
};

}  // namespace tomodem::law
