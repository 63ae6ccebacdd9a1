#include "core/base/polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::polynomial {
namespace {

/// Halves an interval at whose ends `function` has different signs until it cannot be halved any more.
template <class Function>
double bisect(Function function, double low, double high) {
    const bool rising = function(low) < 0;
    for (;;) {
        const double middle = low + (high - low) / 2;
        if (middle <= low || middle >= high) return middle;
        ((function(middle) < 0) == rising ? low : high) = middle;
    }
}

}  // namespace

double value(Coefficients polynomial, double t) {
    double sum = 0;
    for (std::size_t k = polynomial.size(); k-- > 0;) sum = sum * t + polynomial[k];
    return sum;
}

double integral(Coefficients polynomial, double t) {
    double sum = 0;
    for (std::size_t k = polynomial.size(); k-- > 0;) sum = sum * t + polynomial[k] / static_cast<double>(k + 1);
    return sum * t;
}

std::vector<double> derivative(Coefficients polynomial) {
    std::vector<double> result;
    for (std::size_t k = 1; k < polynomial.size(); ++k) result.push_back(static_cast<double>(k) * polynomial[k]);
    return result;
}

std::vector<double> from(Coefficients polynomial, double t) {
    std::vector<double> shifted(polynomial.begin(), polynomial.end());
    for (std::size_t first = 0; first + 1 < shifted.size(); ++first)  // Horner's scheme, once for each coefficient
        for (std::size_t k = shifted.size() - 1; k-- > first;) shifted[k] += t * shifted[k + 1];
    return shifted;
}

std::vector<double> sign_changes(Coefficients polynomial, double low, double high) {
    std::vector<double> roots;
    if (polynomial.size() < 2) return roots;
    // Between two extrema a polynomial is monotonous: at most one root.
    std::vector<double> ends = sign_changes(derivative(polynomial), low, high);
    ends.insert(ends.begin(), low);
    ends.push_back(high);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k)
        if ((value(polynomial, ends[k]) < 0) != (value(polynomial, ends[k + 1]) < 0))
            roots.push_back(bisect([&](double t) { return value(polynomial, t); }, ends[k], ends[k + 1]));
    return roots;
}

std::optional<double> end_of_positive(Coefficients polynomial) {
    while (polynomial.size() > 1 && polynomial.back() == 0) polynomial = polynomial.first(polynomial.size() - 1);
    // Cauchy's bound of the roots.
    double bound = 0;
    for (double coefficient : polynomial) bound = std::max(bound, std::abs(coefficient / polynomial.back()));
    const std::vector<double> roots = sign_changes(polynomial, 0, 1 + bound);
    if (roots.empty()) return {};
    return roots.front();
}

double largest_magnitude(Coefficients polynomial, double end) {
    double largest = std::max(std::abs(value(polynomial, 0)), std::abs(value(polynomial, end)));
    for (double t : sign_changes(derivative(polynomial), 0, end))
        largest = std::max(largest, std::abs(value(polynomial, t)));
    return largest;
}

std::optional<double> time_to_reach(Coefficients polynomial, double target) {
    double high;
    if (const auto end = end_of_positive(polynomial)) {
        high = *end;
        if (integral(polynomial, high) < target) return {};
    } else {
        high = target / polynomial.front();
        while (integral(polynomial, high) < target) high *= 2;
    }
    return bisect([&](double t) { return integral(polynomial, t) - target; }, 0, high);
}

}  // namespace tomodem::polynomial
