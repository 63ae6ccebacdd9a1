#include "core/packing.hpp"

#include <cmath>
#include <numbers>

namespace tomodem {

double Packing::density() const {
    return static_cast<double>(size()) * std::numbers::pi * std::pow(2.0 * seed_radius, 3) / (6.0 * box.volume());
}

}  // namespace tomodem
