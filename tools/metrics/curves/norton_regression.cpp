#include "tools/metrics/curves/norton_regression.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace tomodem::curves {
namespace {

/// P(|T| < t), Abramowitz & Stegun 26.7.3 (odd) and 26.7.4 (even).
double student_probability(double t, int degrees) {
    const double theta = std::atan(t / std::sqrt(double(degrees)));
    const double sine = std::sin(theta), cosine = std::cos(theta);
    double term = degrees % 2 == 0 ? 1.0 : cosine;
    double sum = degrees == 1 ? 0.0 : term;
    for (int k = degrees % 2 == 0 ? 2 : 3; k <= degrees - 2; k += 2) {
        term *= double(k - 1) / k * cosine * cosine;
        sum += term;
    }
    return degrees % 2 == 0 ? sine * sum : 2.0 / std::numbers::pi * (theta + sine * sum);
}

}  // namespace

double student_t(double probability, int degrees) {
    double low = 0.0, high = 1.0;
    while (student_probability(high, degrees) < probability) high *= 2.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (student_probability(middle, degrees) < probability ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

NortonFit norton_fit(std::span<const double> rate, std::span<const double> stress) {
    const std::size_t n = rate.size();
    if (n < 2 || stress.size() != n) throw InvalidInput(fmt::format("a Norton fit needs at least two runs, got {}", n));
    double mean_x = 0.0, mean_y = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(rate[i] > 0.0) || !(stress[i] > 0.0))
            throw InvalidInput(
                fmt::format("run {} of the fit has rate {:g} /s and stress {:g}: both must be more than 0", i + 1,
                            rate[i], stress[i]));
        mean_x += std::log(rate[i]) / double(n);
        mean_y += std::log(stress[i]) / double(n);
    }
    double xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double x = std::log(rate[i]) - mean_x;
        xx += x * x;
        xy += x * (std::log(stress[i]) - mean_y);
    }
    // Rates of runs that were meant to be equal differ in their last digits.
    if (std::sqrt(xx / double(n)) < 1e-3)
        throw InvalidInput(fmt::format("all {} runs have the rate {:.4g} /s; a Norton fit needs different rates", n,
                                       std::exp(mean_x)));
    NortonFit fit;
    fit.M = xy / xx;
    const double intercept = mean_y - fit.M * mean_x;
    fit.K = std::exp(intercept);
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double difference = std::log(stress[i]) - intercept - fit.M * std::log(rate[i]);
        squares += difference * difference;
    }
    fit.residual = std::sqrt(squares / double(n));
    if (n > 2) {
        const double t = student_t(0.95, int(n) - 2);
        const double deviation = std::sqrt(squares / double(n - 2));
        const double half_width_m = t * deviation / std::sqrt(xx);
        const double half_width_log_k = t * deviation * std::sqrt(1.0 / double(n) + mean_x * mean_x / xx);
        fit.M_interval = {fit.M - half_width_m, fit.M + half_width_m};
        fit.K_interval = {std::exp(intercept - half_width_log_k), std::exp(intercept + half_width_log_k)};
    }
    return fit;
}

}  // namespace tomodem::curves
