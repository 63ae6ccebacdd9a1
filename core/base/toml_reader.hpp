#pragma once
#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

/// Reading tables of numbers; includes toml++, so for .cpp files alone.
namespace tomodem {

/// Straight in the logarithm of x, constant beyond the ends.
inline double interpolated_in_logarithm(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto right = std::lower_bound(x.begin(), x.end(), at) - x.begin();
    if (right == 0) return y.front();
    if (right == static_cast<std::ptrdiff_t>(x.size())) return y.back();
    const double share = std::log(at / x[right - 1]) / std::log(x[right] / x[right - 1]);
    return std::lerp(y[right - 1], y[right], share);
}

/// One table of a file of measured numbers, such as a calibration: what is asked for must be there, and what is there
/// must be asked for (`refuse_unknown`).
///
/// @param where  the table's name; empty: the file's root
/// @param file   how errors name the file, as "calibration 'mine.toml'"
/// @throws InvalidInput with file and line, from every member that reads
class TomlReader {
 public:
    TomlReader(const toml::table& table, std::string where, std::string file)
        : table_(table), where_(std::move(where)), file_(std::move(file)) {}

    [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
        throw InvalidInput(fmt::format("{} line {}: {}", file_, std::max(1u, node.source().begin.line), what));
    }

    const toml::node* find(const std::string& key) {
        known_.insert(key);
        return table_.get(key);
    }
    const toml::node& get(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) fail(table_, fmt::format("[{}] has no '{}'", where_, key));
        return *node;
    }

    double number(const toml::node& node, const std::string& key, double least) const {
        const auto value = node.is_number() ? node.value<double>() : std::nullopt;
        if (!value || !(*value >= least) || !std::isfinite(*value))
            fail(node, fmt::format("{} in [{}] must be a number of at least {:g}", key, where_, least));
        return *value;
    }
    double number(const std::string& key, double least = 0) { return number(get(key), key, least); }
    std::optional<double> optional(const std::string& key, double least = 0) {
        const toml::node* node = find(key);
        return node == nullptr ? std::nullopt : std::optional(number(*node, key, least));
    }
    double positive(const std::string& key) {
        const double value = number(key);
        if (value == 0) fail(get(key), fmt::format("{} in [{}] must be above 0", key, where_));
        return value;
    }
    std::string text(const std::string& key) {
        const auto value = get(key).value_exact<std::string>();
        if (!value) fail(get(key), fmt::format("{} in [{}] must be a string", key, where_));
        return *value;
    }
    /// @param length  0: any but none
    std::vector<double> list(const std::string& key, std::size_t length = 0, double least = 0) {
        const toml::node& node = get(key);
        std::vector<double> values;
        if (const toml::array* array = node.as_array())
            for (const toml::node& one : *array) values.push_back(number(one, key, least));
        if (values.empty() || (length > 0 && values.size() != length))
            fail(node, fmt::format("{} in [{}] must be a list of {} numbers", key, where_,
                                   length > 0 ? std::to_string(length) : "one or more"));
        return values;
    }
    std::vector<double> rising(const std::string& key) {
        const std::vector<double> values = list(key);
        if (values.front() <= 0 ||
            std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
            fail(get(key), fmt::format("{} in [{}] must rise, from above 0", key, where_));
        return values;
    }
    std::array<double, 2> pair(const std::string& key) {
        const std::vector<double> values = list(key, 2);
        return {values[0], values[1]};
    }
    std::array<double, 2> range(const std::string& key) {
        const std::array<double, 2> values = pair(key);
        if (values[0] > values[1]) fail(get(key), fmt::format("{} in [{}] must be [least, greatest]", key, where_));
        return values;
    }
    std::optional<TomlReader> table(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        const std::string name = where_.empty() ? key : where_ + "." + key;
        if (!node->is_table()) fail(*node, fmt::format("{} must be a table, [{}]", key, name));
        return TomlReader(*node->as_table(), name, file_);
    }
    void refuse_unknown() const {
        for (const auto& [key, node] : table_)
            if (!known_.contains(std::string(key.str())))
                fail(node,
                     fmt::format("unknown key '{}' in [{}]; known are {}", key.str(), where_, fmt::join(known_, ", ")));
    }

 private:
    const toml::table& table_;
    std::string where_;
    std::string file_;
    std::set<std::string> known_;
};

}  // namespace tomodem
