#pragma once
#include <optional>
#include <span>
#include <vector>

/// Polynomials of time, coefficients from the constant on: c[0] + c[1] t + c[2] t^2 + ...
namespace tomodem::polynomial {

using Coefficients = std::span<const double>;

double value(Coefficients polynomial, double t);
/// Integral from 0 to t.
double integral(Coefficients polynomial, double t);
std::vector<double> derivative(Coefficients polynomial);

/// The same polynomial of the time after `t`.
std::vector<double> from(Coefficients polynomial, double t);

/// Real roots of odd order (where the sign changes) in (low, high), increasing, each to the last digits.
std::vector<double> sign_changes(Coefficients polynomial, double low, double high);

/// First t > 0 at which the polynomial, positive just after 0, changes its sign; nothing if it stays positive.
std::optional<double> end_of_positive(Coefficients polynomial);

/// Largest |value| in [0, end].
double largest_magnitude(Coefficients polynomial, double end);

/// The t > 0 at which the integral from 0 reaches `target` > 0 for the first time, the polynomial positive until then;
/// nothing if it changes its sign before.
std::optional<double> time_to_reach(Coefficients polynomial, double target);

}  // namespace tomodem::polynomial
