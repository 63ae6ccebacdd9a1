#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"

namespace tomodem::fields {

/// How neighbours count in an average over space: all alike within a radius, or less with distance.
enum class Kernel { ball, gaussian };

/// Where a kernel ends: at the radius of the ball; at 1.5 times it for the Gaussian, whose standard deviation along an
/// axis is radius / sqrt(5), that of the ball.
double reach_of(Kernel kernel, double radius);

struct SpaceAverage {
    Kernel kernel = Kernel::ball;
    double radius = 0.0;                         ///< mm, more than 0
    std::span<const std::int32_t> species = {};  ///< if given, only particles of the same label are averaged
};

/// The mean of a quantity over the particles around each one, itself too, component by component.
///
/// Near a free face it is the mean over the particles that are there. The box repeats along its periodic axes.
///
/// @param values  size() x components, row by row; a row that is not finite makes those around it not finite
/// @throws InvalidInput if the radius is not positive or reaches beyond half of a periodic edge
/// @note   time O(N neighbours); the same on any number of threads
std::vector<double> averaged_in_space(std::span<const Vec3> points, const Box& box, std::span<const double> values,
                                      int components, const SpaceAverage& average, int threads = 1);

/// Components in the order of the run files: xx yy zz xy xz yz.
using Symmetric = std::array<double, 6>;

/// Mises' equivalent stress sqrt(3/2 s:s), s the deviator, with the sign of the trace (positive where that is zero).
double signed_equivalent(std::span<const double, 6> stress);

/// Minus a third of the trace: positive in compression.
double pressure(std::span<const double, 6> stress);

}  // namespace tomodem::fields
