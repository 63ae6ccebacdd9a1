#include "core/law/bilin_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace tomodem::law {

double BilinFlow::at(double value) const {
    if (value <= chi.front()) return flow.front();
    if (value > chi.back())
        throw InvalidInput(
            fmt::format("rate * t0^2 / time_step = {:g} is above {:g}, where the table of BILIN ends (above {:g} the "
                        "packing collapses); use a lower rate or a shorter natural period",
                        value, chi.back(), max_chi));
    const auto right = std::lower_bound(chi.begin(), chi.end(), value) - chi.begin();
    const auto left = right - 1;
    const double share = std::log(value / chi[left]) / std::log(chi[right] / chi[left]);
    return flow[left] * std::pow(flow[right] / flow[left], share);
}

double BilinFlow::sensitivity(double value) const {
    return std::log10(at(value) / at(value / 10));
}

double BilinFlow::chi_for(double rate_sensitivity) const {
    if (rate_sensitivity > max_sensitivity)
        throw InvalidInput(
            fmt::format("a rate sensitivity M = {:g} is out of reach of law \"bilin\", which holds up to {:g}; law "
                        "\"norton\" can, for any M up to 1",
                        rate_sensitivity, max_sensitivity));
    const double plateau = 2 * chi.front();
    const double steepest = *std::max_element(chi.begin(), chi.end(),
                                              [this](double a, double b) { return sensitivity(a) < sensitivity(b); });
    if (rate_sensitivity >= sensitivity(steepest)) return steepest;
    if (rate_sensitivity <= sensitivity(plateau)) return 0;
    double low = plateau, high = steepest;
    while (high / low > 1 + 1e-9) {
        const double middle = std::sqrt(low * high);
        (sensitivity(middle) < rate_sensitivity ? low : high) = middle;
    }
    return high;
}

}  // namespace tomodem::law
