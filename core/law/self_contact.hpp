#pragma once
#include <cmath>

namespace tomodem::law {

/// Thresholds of self-contact (thesis section 15.1): when a new pair is the contact of two surfaces of one object.
struct SelfContact {
    double min_outward;                               ///< N_mag: an outward vector this long marks a free surface [mm]
    double cos_line = 0.17364817766693033;            ///< cos 80 deg, between an outward vector and the pair's line
    double cos_outward = 0.42261826174069944;         ///< cos 65 deg, between the two outward vectors
    static constexpr double outward_over_seed = 4.6;  ///< N_mag / r_s: 2.3 mm at r_s = 0.5 mm
    static constexpr double crown_over_seed = 3.0;    ///< 2 r_c / r_s, of the crown that N_mag was chosen with
};

/// Whether a pair that forms now is an interface, which only repels, or internal.
///
/// @param outward_i, outward_j  n = - sum of the vectors to the internal neighbours in the crown [mm], 3 numbers
/// @param line                  from i to j [mm], any length above 0
/// The answer is the same bit by bit when i and j change places.
inline bool is_interface(const SelfContact& law, const double* outward_i, const double* outward_j, const double* line) {
    const auto dot = [](const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const double length_i = std::sqrt(dot(outward_i, outward_i)), length_j = std::sqrt(dot(outward_j, outward_j));
    const double length = std::sqrt(dot(line, line));
    if (dot(outward_i, outward_j) > law.cos_outward * (length_i * length_j)) return false;
    const bool i_faces = length_i >= law.min_outward && dot(outward_i, line) >= law.cos_line * (length_i * length);
    const bool j_faces = length_j >= law.min_outward && -dot(outward_j, line) >= law.cos_line * (length_j * length);
    return i_faces || j_faces;
}

}  // namespace tomodem::law
