#include "core/base/table.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/output_file.hpp"

namespace tomodem {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
    return result + "\"";
}

nlohmann::ordered_json in_json(const Table::Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell)) {
        if (std::isfinite(*value)) return *value;
        return nullptr;
    }
    if (const auto* value = std::get_if<std::int64_t>(&cell)) return *value;
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return nullptr;
}

struct Shown {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(double value) const { return fmt::format("{:.10g}", value); }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& text) const { return quoted(text); }
};

}  // namespace

void Table::add(std::vector<Cell> row) {
    assert(row.size() == columns_.size());
    rows_.push_back(std::move(row));
}

std::string Table::csv() const {
    std::string text;
    const auto line = [&](const auto& cells, const auto& shown) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (i > 0) text += ',';
            text += shown(cells[i]);
        }
        text += '\n';
    };
    line(columns_, quoted);
    for (const auto& row : rows_) line(row, [](const Cell& cell) { return std::visit(Shown(), cell); });
    return text;
}

nlohmann::ordered_json Table::json() const {
    auto rows = nlohmann::ordered_json::array();
    for (const auto& cells : rows_) {
        nlohmann::ordered_json row;
        for (std::size_t i = 0; i < columns_.size(); ++i)
            row[columns_[i].substr(0, columns_[i].find(" ["))] = in_json(cells[i]);
        rows.push_back(std::move(row));
    }
    return rows;
}

Table::Cell number(double value) {
    return std::isfinite(value) ? Table::Cell(value) : Table::Cell();
}

void Table::write(const std::filesystem::path& path) const {
    write_text(path, csv());
}

}  // namespace tomodem
