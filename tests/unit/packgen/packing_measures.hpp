#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/packing/packing.hpp"

/// Measures of a cubic periodic packing by all pairs, O(N^2): the oracle of these tests. Lengths in diameters.
namespace tomodem::packgen {

struct Pair {
    std::size_t i, j;
    Vec3 direction;   ///< unit vector
    double distance;  ///< over d
};

/// All pairs i < j closer than `reach`.
std::vector<Pair> pairs_within(const Packing& packing, double reach);

/// g(r) in `shells` equal shells up to `reach`.
std::vector<double> radial_distribution(const Packing& packing, double reach, std::size_t shells);

/// Mean of e e^T over the pairs; a third of the unit matrix when isotropic.
Eigen::Matrix3d fabric(const std::vector<Pair>& pairs);

/// Global bond-orientational order Q6 of the pairs: 0.575 for fcc, 0.485 for hcp, about 1 / sqrt(pairs) for a glass.
/// @see Steinhardt, Nelson & Ronchetti, Phys. Rev. B 28 (1983) 784
double global_q6(const std::vector<Pair>& pairs);

/// Variance over mean of the number of centres in cells^3 equal cells: 1 for independent points.
double number_variance(const Packing& packing, int cells);

/// Four spheres a cell, touching when d = 1.
Packing fcc(int cells);

}  // namespace tomodem::packgen
