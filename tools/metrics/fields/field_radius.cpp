#include "tools/metrics/fields/field_radius.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace tomodem::fields {

void require_smaller_than_sample(double radius, const Packing& packing) {
    Vec3 low = packing.position.front(), high = low;
    for (const Vec3& p : packing.position) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double extent = (high - low).maxCoeff();
    if (radius > extent)
        throw InvalidInput(fmt::format(
            "--radius {:g} mm is larger than the sample, whose centres lie within {:.4g} mm: take a smaller "
            "one",
            radius, extent));
}

}  // namespace tomodem::fields
