#include "core/packing/packing.hpp"

#include <cmath>
#include <numbers>

namespace tomodem {

double Packing::density() const {
    if (!radius.empty()) {
        double cubes = 0.0;
        for (const double r : radius) cubes += r * r * r;
        return 4.0 / 3.0 * std::numbers::pi * cubes / box.volume();
    }
    return static_cast<double>(size()) * std::numbers::pi * std::pow(2.0 * seed_radius, 3) / (6.0 * box.volume());
}

}  // namespace tomodem
