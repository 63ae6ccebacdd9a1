#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace tomodem {

/// Two things that could belong together, and how well.
struct Candidate {
    std::int32_t left, right;
    double score;  ///< more than 0
};

/// The pairs, each left and each right in one at most, whose scores have the largest sum.
///
/// @param candidates  any order; one a pair
/// @return            by rising left; the same for every order of the candidates
/// @note   time O(n^3) in the largest set of things that candidates connect
/// @see    Kuhn, Naval Research Logistics Quarterly 2 (1955) 83; shortest augmenting paths by Jonker & Volgenant,
///         Computing 38 (1987) 325
std::vector<std::pair<std::int32_t, std::int32_t>> best_pairs(std::vector<Candidate> candidates);

}  // namespace tomodem
