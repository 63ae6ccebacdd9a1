#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace tomodem {

/// A CSV table: one header line of "name [unit]" ("[-]" without a unit), then one line a row; empty where a number does
/// not exist.
class Table {
 public:
    using Cell = std::variant<std::monostate, double, std::int64_t, std::string>;

    explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}
    void add(std::vector<Cell> row);
    std::size_t rows() const { return rows_.size(); }
    std::string csv() const;
    /// The rows as a list of JSON objects; names without their units, null where a number does not exist.
    nlohmann::ordered_json json() const;
    /// Writes atomically. @throws InvalidInput if it cannot be written
    void write(const std::filesystem::path& path) const;

 private:
    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
};

/// A number, or the empty cell where it is not finite.
Table::Cell number(double value);

}  // namespace tomodem
