#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace tomodem::shapes {

/// Two objects that could be the same one, and a score for it.
struct Candidate {
    std::int32_t left, right;
    double score;  ///< more than 0
};

/// The pairs, each left and each right in one at most, whose scores have the largest sum.
///
/// @param candidates  any order; one a pair
/// @return            by rising left; the same for every order of the candidates
/// @note   at most n searches of m log m, n things with m candidates; short ones where few candidates compete
/// @see    Edmonds & Karp, Journal of the ACM 19 (1972) 248: shortest augmenting paths with prices
std::vector<std::pair<std::int32_t, std::int32_t>> best_pairs(std::vector<Candidate> candidates);

}  // namespace tomodem::shapes
