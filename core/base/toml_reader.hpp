#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

/// Reading TOML: scenes, and tables of measured numbers. Includes toml++, so for .cpp files alone.
namespace tomodem {

/// Straight in the logarithm of x, constant beyond the ends.
inline double interpolated_in_logarithm(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto right = std::lower_bound(x.begin(), x.end(), at) - x.begin();
    if (right == 0) return y.front();
    if (right == static_cast<std::ptrdiff_t>(x.size())) return y.back();
    const double share = std::log(at / x[right - 1]) / std::log(x[right] / x[right - 1]);
    return std::lerp(y[right - 1], y[right], share);
}

/// The tables of a TOML text.
/// @param file  how errors name it, as "scene 'mine.toml'"
/// @throws InvalidInput with file and line: syntax
inline toml::table parse_toml(const std::string& text, const std::string& file) {
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        throw InvalidInput(fmt::format("{} line {}: {}", file, error.source().begin.line, error.description()));
    }
}

/// One table of a TOML file. Keys that nobody asks for are errors (`refuse_unknown`).
///
/// @param where  the table in the words of an error: "[load]", "a step of [load]"; empty: the file's root
/// @param file   how errors name the file, as "calibration 'mine.toml'"
/// @throws InvalidInput with file and line, from every member that reads
class TomlReader {
 public:
    /// Reads a quantity with a unit, as "500 um" (core/base/units.hpp).
    using WithUnit = double (*)(std::string_view);

    TomlReader(const toml::table& table, std::string where, std::string file)
        : table_(table), where_(std::move(where)), file_(std::move(file)) {}

    [[noreturn]] void fail(std::int64_t line, const std::string& what) const {
        throw InvalidInput(fmt::format("{} line {}: {}", file_, std::max<std::int64_t>(1, line), what));
    }
    [[noreturn]] void fail(const toml::node& node, const std::string& what) const { fail(line_of(node), what); }
    [[noreturn]] void fail(const std::string& what) const { fail(line(), what); }

    static std::int64_t line_of(const toml::node& node) { return node.source().begin.line; }
    /// The table's own.
    std::int64_t line() const { return std::max<std::int64_t>(1, line_of(table_)); }
    const std::string& file() const { return file_; }

    const toml::node* find(const std::string& key) {
        known_.insert(key);
        return table_.get(key);
    }
    const toml::node& get(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) fail(fmt::format("{} has no '{}'", where_.empty() ? "the file" : where_, key));
        return *node;
    }

    /// A key that must not be here; it is not listed among those that are known.
    void refuse(const std::string& key, const std::string& why) const {
        if (const toml::node* node = table_.get(key)) fail(*node, why);
    }

    /// A number, finite and of at least `min`.
    double number(const toml::node& node, const std::string& key, double min) const {
        const auto value = node.is_number() ? node.value<double>() : std::nullopt;
        if (!value || !(*value >= min) || !std::isfinite(*value))
            fail(node, fmt::format("{} in {} must be a number of at least {:g}", key, where_, min));
        return *value;
    }
    double number(const std::string& key, double min = 0) { return number(get(key), key, min); }
    std::optional<double> optional(const std::string& key, double min = 0) {
        const toml::node* node = find(key);
        return node == nullptr ? std::nullopt : std::optional(number(*node, key, min));
    }
    double positive(const std::string& key) {
        const double value = number(key);
        if (value == 0) fail(get(key), fmt::format("{} in {} must be above 0", key, where_));
        return value;
    }

    /// Any number, or a string with a unit where the quantity has one.
    double quantity(const toml::node& node, const std::string& key, WithUnit with_unit = nullptr) const {
        if (const auto value = node.value<double>(); value && node.is_number()) return *value;
        if (with_unit != nullptr && node.is_string()) {
            try {
                return with_unit(*node.value<std::string>());
            } catch (const InvalidInput& error) {
                fail(node, fmt::format("{} in {}: {}", key, where_, error.what()));
            }
        }
        fail(node, fmt::format("{} in {} must be a number{}", key, where_,
                               with_unit != nullptr ? ", or a string with a unit" : ""));
    }
    std::optional<double> optional_positive(const std::string& key, WithUnit with_unit = nullptr) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        const double value = quantity(*node, key, with_unit);
        if (!(value > 0) || !std::isfinite(value))
            fail(*node, fmt::format("{} in {} is {:g}: expected more than 0", key, where_, value));
        return value;
    }
    std::optional<std::int64_t> optional_integer(const std::string& key, std::int64_t min) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        const auto value = node->value_exact<std::int64_t>();
        if (!value || *value < min)
            fail(*node, fmt::format("{} in {} must be a whole number of at least {}", key, where_, min));
        return value;
    }
    std::optional<bool> optional_boolean(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        const auto value = node->value_exact<bool>();
        if (!value) fail(*node, fmt::format("{} in {} must be true or false", key, where_));
        return value;
    }
    std::optional<std::string> optional_text(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        const auto value = node->value_exact<std::string>();
        if (!value) fail(*node, fmt::format("{} in {} must be a string", key, where_));
        return value;
    }
    std::string text(const std::string& key) {
        get(key);
        return *optional_text(key);
    }

    /// @param length  0: any but none
    std::vector<double> list(const std::string& key, std::size_t length = 0, double min = 0) {
        const toml::node& node = get(key);
        std::vector<double> values;
        if (const toml::array* array = node.as_array())
            for (const toml::node& one : *array) values.push_back(number(one, key, min));
        if (values.empty() || (length > 0 && values.size() != length))
            fail(node, fmt::format("{} in {} must be a list of {} numbers", key, where_,
                                   length > 0 ? std::to_string(length) : "one or more"));
        return values;
    }
    std::vector<double> rising(const std::string& key) {
        const std::vector<double> values = list(key);
        if (values.front() <= 0 ||
            std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
            fail(get(key), fmt::format("{} in {} must rise, from above 0", key, where_));
        return values;
    }
    std::array<double, 2> pair(const std::string& key) {
        const std::vector<double> values = list(key, 2);
        return {values[0], values[1]};
    }
    std::array<double, 2> range(const std::string& key) {
        const std::array<double, 2> values = pair(key);
        if (values[0] > values[1]) fail(get(key), fmt::format("{} in {} must be [smallest, largest]", key, where_));
        return values;
    }

    std::optional<TomlReader> table(const std::string& key, const std::string& where) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        if (!node->is_table()) fail(*node, fmt::format("{} must be a table", where));
        return TomlReader(*node->as_table(), where, file_);
    }
    /// Named after the tables that it stands in: "[calibration.bilin]".
    std::optional<TomlReader> table(const std::string& key) {
        const bool within = where_.starts_with('[') && where_.ends_with(']');
        return table(key, within ? fmt::format("{}.{}]", where_.substr(0, where_.size() - 1), key) : "[" + key + "]");
    }

    void refuse_unknown() const {
        for (const auto& [key, node] : table_)
            if (!known_.contains(std::string(key.str())))
                fail(key.source().begin.line,
                     fmt::format("unknown key '{}' in {}; known are {}", key.str(),
                                 where_.empty() ? "the file" : where_, fmt::join(known_, ", ")));
    }

 private:
    const toml::table& table_;
    std::string where_;
    std::string file_;
    std::set<std::string> known_;
};

}  // namespace tomodem
