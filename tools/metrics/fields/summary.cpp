#include "tools/metrics/fields/summary.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::fields {

Summary summary(const Component& field, std::span<const std::int32_t> species, std::optional<std::int32_t> label) {
    const auto for_each = [&](const auto& visit) {
        for (std::size_t i = 0; i < species.size(); ++i) {
            const double value = field.values[i * field.components + field.component];
            if ((!label || species[i] == *label) && std::isfinite(value)) visit(value);
        }
    };
    Summary result;
    double sum = 0.0, min = std::numeric_limits<double>::infinity(), max = -min;
    for_each([&](double value) {
        ++result.count;
        sum += value;
        min = std::min(min, value);
        max = std::max(max, value);
    });
    if (result.count == 0) return result;
    result.min = min;
    result.max = max;
    result.mean = sum / double(result.count);
    double squares = 0.0;
    for_each([&](double value) { squares += (value - result.mean) * (value - result.mean); });
    result.deviation = std::sqrt(squares / double(result.count));
    return result;
}

}  // namespace tomodem::fields
