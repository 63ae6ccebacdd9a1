#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace tomodem::fields {

/// Mean, spread and range of the finite values of a selection; not numbers where there is none.
struct Summary {
    std::int64_t count = 0;
    double mean = std::numeric_limits<double>::quiet_NaN(), deviation = mean, min = mean, max = mean;
};

/// One component of a field: values k of row i at i * components + component, a row a particle.
struct Component {
    std::span<const double> values;
    std::size_t components = 1, component = 0;
};

/// @param species  label of each particle
/// @param label    only particles of this one, or all
Summary summary(const Component& field, std::span<const std::int32_t> species, std::optional<std::int32_t> label = {});

}  // namespace tomodem::fields
