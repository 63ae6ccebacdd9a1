#include "tools/metrics/shapes/assignment.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace tomodem::shapes {
namespace {

/// A right that a left can have, and what it costs; the last one of each left costs nothing: to stay alone.
struct Edge {
    std::size_t right;
    double cost;
};

/// Rights of the lefts so that the sum of the costs is smallest: each left in turn takes the cheapest way of exchanges
/// that ends at a right that nobody has. Prices keep the costs on the way from being negative.
std::vector<std::size_t> cheapest_rights(const std::vector<std::vector<Edge>>& edges, std::size_t rights) {
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    constexpr double far = std::numeric_limits<double>::infinity();
    std::vector<double> left_price(edges.size(), 0.0), right_price(rights, 0.0), distance(rights, far);
    std::vector<std::size_t> left_of(rights, none), right_of(edges.size(), none), from(rights, none);
    std::vector<bool> settled(rights, false);
    for (std::size_t i = 0; i < edges.size(); ++i)
        for (const Edge& edge : edges[i]) left_price[i] = std::min(left_price[i], edge.cost);

    for (std::size_t start = 0; start < edges.size(); ++start) {
        using Reached = std::pair<double, std::size_t>;
        std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
        std::vector<std::size_t> touched, on_the_way;
        const auto look_from = [&](std::size_t left, double way) {
            for (const auto& [right, cost] : edges[left]) {
                const double next = way + cost - left_price[left] - right_price[right];
                if (settled[right] || !(next < distance[right])) continue;
                if (distance[right] == far) touched.push_back(right);
                distance[right] = next;
                from[right] = left;
                queue.emplace(next, right);
            }
        };
        look_from(start, 0.0);
        std::size_t end = none;
        while (end == none) {
            const auto [way, right] = queue.top();
            queue.pop();
            if (settled[right]) continue;
            settled[right] = true;
            if (left_of[right] == none) {
                end = right;
            } else {
                on_the_way.push_back(right);
                look_from(left_of[right], way);
            }
        }
        const double whole = distance[end];
        left_price[start] += whole;
        for (const std::size_t right : on_the_way) {
            left_price[left_of[right]] += whole - distance[right];
            right_price[right] -= whole - distance[right];
        }
        for (std::size_t right = end; right != none;) {
            const std::size_t left = from[right], before = right_of[left];
            left_of[right] = left;
            right_of[left] = right;
            right = left == start ? none : before;
        }
        for (const std::size_t right : touched) {
            distance[right] = far;
            settled[right] = false;
        }
    }
    return right_of;
}

std::vector<std::int32_t> sorted_unique(std::vector<std::int32_t> values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

std::size_t place(const std::vector<std::int32_t>& sorted, std::int32_t value) {
    return std::size_t(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> best_pairs(std::vector<Candidate> candidates) {
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::tie(a.left, a.right) < std::tie(b.left, b.right);
    });
    std::vector<std::int32_t> lefts, rights;
    for (const Candidate& candidate : candidates) {
        lefts.push_back(candidate.left);
        rights.push_back(candidate.right);
    }
    lefts = sorted_unique(lefts);
    rights = sorted_unique(rights);
    std::vector<std::vector<Edge>> edges(lefts.size());
    for (const Candidate& candidate : candidates)
        edges[place(lefts, candidate.left)].push_back({place(rights, candidate.right), -candidate.score});
    for (std::size_t i = 0; i < lefts.size(); ++i) edges[i].push_back({rights.size() + i, 0.0});

    const std::vector<std::size_t> right_of = cheapest_rights(edges, rights.size() + lefts.size());
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (std::size_t i = 0; i < lefts.size(); ++i)
        if (right_of[i] < rights.size()) pairs.emplace_back(lefts[i], rights[right_of[i]]);
    return pairs;
}

}  // namespace tomodem::shapes
