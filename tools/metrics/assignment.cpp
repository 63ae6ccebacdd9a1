#include "tools/metrics/assignment.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace tomodem {
namespace {

/// Columns that rows get so that the sum of the costs is least. @param cost  rows <= columns
std::vector<std::size_t> cheapest_columns(const std::vector<std::vector<double>>& cost) {
    const std::size_t rows = cost.size(), columns = cost.front().size();
    constexpr double infinite = std::numeric_limits<double>::infinity();
    // Place 0 of each list stands for "none"; rows and columns are counted from 1.
    std::vector<double> row_price(rows + 1, 0.0), column_price(columns + 1, 0.0);
    std::vector<std::size_t> row_of(columns + 1, 0), before(columns + 1, 0);
    for (std::size_t row = 1; row <= rows; ++row) {
        std::vector<double> least(columns + 1, infinite);
        std::vector<bool> reached(columns + 1, false);
        std::size_t column = 0;
        row_of[0] = row;
        while (row_of[column] != 0) {
            reached[column] = true;
            const std::size_t from = row_of[column];
            std::size_t next = 0;
            double step = infinite;
            for (std::size_t j = 1; j <= columns; ++j) {
                if (reached[j]) continue;
                const double reduced = cost[from - 1][j - 1] - row_price[from] - column_price[j];
                if (reduced < least[j]) {
                    least[j] = reduced;
                    before[j] = column;
                }
                if (least[j] < step) {
                    step = least[j];
                    next = j;
                }
            }
            for (std::size_t j = 0; j <= columns; ++j) {
                if (reached[j]) {
                    row_price[row_of[j]] += step;
                    column_price[j] -= step;
                } else {
                    least[j] -= step;
                }
            }
            column = next;
        }
        while (column != 0) {
            row_of[column] = row_of[before[column]];
            column = before[column];
        }
    }
    std::vector<std::size_t> column_of(rows, 0);
    for (std::size_t j = 1; j <= columns; ++j)
        if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
    return column_of;
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

    // What no candidate connects is assigned apart.
    std::vector<std::size_t> parent(lefts.size() + rights.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::size_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (const Candidate& candidate : candidates) {
        const std::size_t a = root(place(lefts, candidate.left));
        const std::size_t b = root(lefts.size() + place(rights, candidate.right));
        parent[std::max(a, b)] = std::min(a, b);
    }
    std::map<std::size_t, std::vector<Candidate>> groups;
    for (const Candidate& candidate : candidates) groups[root(place(lefts, candidate.left))].push_back(candidate);

    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (const auto& [first, group] : groups) {
        std::vector<std::int32_t> own_lefts, own_rights;
        for (const Candidate& candidate : group) {
            own_lefts.push_back(candidate.left);
            own_rights.push_back(candidate.right);
        }
        own_lefts = sorted_unique(own_lefts);
        own_rights = sorted_unique(own_rights);
        const bool turned = own_lefts.size() > own_rights.size();
        const std::vector<std::int32_t>& rows = turned ? own_rights : own_lefts;
        const std::vector<std::int32_t>& columns = turned ? own_lefts : own_rights;
        std::vector<std::vector<double>> cost(rows.size(), std::vector<double>(columns.size(), 0.0));
        for (const Candidate& candidate : group)
            cost[place(rows, turned ? candidate.right : candidate.left)]
                [place(columns, turned ? candidate.left : candidate.right)] = -candidate.score;
        const std::vector<std::size_t> column_of = cheapest_columns(cost);
        for (std::size_t row = 0; row < rows.size(); ++row) {
            if (cost[row][column_of[row]] == 0.0) continue;
            const std::int32_t column = columns[column_of[row]];
            pairs.emplace_back(turned ? column : rows[row], turned ? rows[row] : column);
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace tomodem
