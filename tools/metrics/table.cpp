#include "tools/metrics/table.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "core/output_file.hpp"

namespace tomodem {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
    return result + "\"";
}

struct ShownInJson {
    std::string operator()(std::monostate) const { return "null"; }
    std::string operator()(double value) const { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& text) const { return in_json(text); }
    static std::string in_json(const std::string& text) {
        std::string result = "\"";
        for (const char c : text) {
            if (c == '"' || c == '\\') result += '\\';
            result += c == '\n' ? ' ' : c;
        }
        return result + '"';
    }
};

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

std::string Table::json() const {
    std::string text = "[";
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        text += r > 0 ? ",{" : "{";
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const std::string name = columns_[i].substr(0, columns_[i].find(" ["));
            text += fmt::format("{}{}:{}", i > 0 ? "," : "", ShownInJson::in_json(name),
                                std::visit(ShownInJson(), rows_[r][i]));
        }
        text += '}';
    }
    return text + ']';
}

Table::Cell number(double value) {
    return std::isfinite(value) ? Table::Cell(value) : Table::Cell();
}

void Table::write(const std::filesystem::path& path) const {
    write_text(path, csv());
}

}  // namespace tomodem
