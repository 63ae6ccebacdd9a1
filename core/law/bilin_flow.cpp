#include "core/law/bilin_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"

namespace tomodem::law {
namespace {

struct Point {
    double chi, g;
};

// One phase, D = 0.70, time_step / t0 <= 0.05.
constexpr std::array<Point, 14> curve{{{.01, .0150},
                                       {.02, .0157},
                                       {.04, .0163},
                                       {.05, .0170},
                                       {.08, .0186},
                                       {.16, .0213},
                                       {.2, .0230},
                                       {.32, .0287},
                                       {.64, .0414},
                                       {1.28, .0583},
                                       {2.56, .0699},
                                       {5.1, .0742},
                                       {10, .0762},
                                       {41, .0804}}};

constexpr double plateau_chi = 0.02;
constexpr double steepest_chi = 1.28;
constexpr double highest_sensitivity = 0.5;

}  // namespace

double bilin_master_curve(double chi) {
    if (chi <= curve.front().chi) return curve.front().g;
    if (chi > curve.back().chi)
        throw InvalidInput(
            fmt::format("rate * t0^2 / time_step = {:g} is above {:g}, where BILIN collapses; "
                        "use a lower rate or a shorter natural period",
                        chi, curve.back().chi));
    const auto right = std::lower_bound(curve.begin(), curve.end(), chi,
                                        [](const Point& point, double value) { return point.chi < value; });
    const auto left = right - 1;
    const double share = std::log(chi / left->chi) / std::log(right->chi / left->chi);
    return left->g * std::pow(right->g / left->g, share);
}

double bilin_rate_sensitivity(double chi) {
    return std::log10(bilin_master_curve(chi) / bilin_master_curve(chi / 10));
}

double bilin_chi_for(double rate_sensitivity) {
    if (rate_sensitivity > highest_sensitivity)
        throw InvalidInput(
            fmt::format("a rate sensitivity M = {:g} is out of reach of law \"bilin\", which holds up to "
                        "{:g}",
                        rate_sensitivity, highest_sensitivity));
    if (rate_sensitivity >= bilin_rate_sensitivity(steepest_chi)) return steepest_chi;
    if (rate_sensitivity <= bilin_rate_sensitivity(plateau_chi)) return 0;
    double low = plateau_chi, high = steepest_chi;
    while (high / low > 1 + 1e-9) {
        const double middle = std::sqrt(low * high);
        (bilin_rate_sensitivity(middle) < rate_sensitivity ? low : high) = middle;
    }
    return high;
}

}  // namespace tomodem::law
