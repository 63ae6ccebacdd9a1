#pragma once
#include <optional>
#include <span>

namespace tomodem::curves {

struct Interval {
    double low, high;
};

/// sigma = K rate^M.
struct NortonFit {
    double K = 0.0;  ///< unit of the stresses times s^M
    double M = 0.0;
    std::optional<Interval> K_interval, M_interval;  ///< 95 % confidence; none for two points
    double residual = 0.0;                           ///< root mean square of ln(sigma) - ln(fit)
};

/// Least squares of ln(sigma) against ln(rate): all runs count alike, whatever their stress.
///
/// The intervals are those of a straight line with normal errors of unknown, equal variance (Student's t, n - 2 degrees
/// of freedom); that of K is exp() of that of ln K, so not symmetric. K is the stress at 1/s, most often far outside
/// the rates tested, which its interval shows.
///
/// @param rate    n >= 2 rates [1/s], more than 0, not all equal
/// @param stress  n stresses, more than 0
/// @throws InvalidInput if one of these conditions does not hold
/// @see    Draper & Smith, Applied Regression Analysis, 3rd ed. (1998), section 1.4
NortonFit norton_fit(std::span<const double> rate, std::span<const double> stress);

/// The t for which a Student variable of `degrees` degrees of freedom is within [-t, t] with this probability.
double student_t(double probability, int degrees);

}  // namespace tomodem::curves
