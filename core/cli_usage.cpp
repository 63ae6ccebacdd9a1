#include "core/cli_usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace tomodem::cli {
namespace {

std::string unit_text(Unit unit) {
    switch (unit) {
        case Unit::none:
            return "";
        case Unit::length:
            return "length with its unit, such as 2.4um";
        case Unit::strain:
            return "true strain";
        case Unit::rate:
            return "1/s";
        case Unit::fraction:
            return "fraction";
        case Unit::percent:
            return "%";
        case Unit::voxels:
            return "voxels";
        case Unit::steps:
            return "steps";
        case Unit::particles:
            return "particles";
    }
    return "";
}

std::string value_name(const Argument& argument) {
    using Kind = Argument::Kind;
    switch (argument.kind) {
        case Kind::number:
            return argument.unit == Unit::length ? "LENGTH" : "NUMBER";
        case Kind::integer:
            return "INTEGER";
        case Kind::text:
            return "TEXT";
        case Kind::choice:
            return fmt::format("{}", fmt::join(argument.choices, "|"));
        case Kind::flag:
            return "";
        default:
            return "FILE";
    }
}

std::string full_help(const Argument& argument) {
    std::string text = argument.help;
    std::vector<std::string> remarks;
    if (!unit_text(argument.unit).empty()) remarks.push_back(unit_text(argument.unit));
    if (!argument.range.text().empty()) remarks.push_back(argument.range.text());
    if (argument.required && argument.name.starts_with("--")) remarks.push_back("required");
    if (!argument.default_text.empty()) remarks.push_back("default " + argument.default_text);
    if (!remarks.empty()) text += fmt::format(" [{}]", fmt::join(remarks, "; "));
    return text;
}

}  // namespace

std::string Range::text() const {
    const bool lower = std::isfinite(low), upper = std::isfinite(high);
    const std::string from = fmt::format("{} {:g}", low_included ? "at least" : "more than", low);
    const std::string to = fmt::format("{} {:g}", high_included ? "at most" : "less than", high);
    if (lower && upper) return from + " and " + to;
    return lower ? from : upper ? to : "";
}

bool Range::contains(double value) const {
    return (low_included ? value >= low : value > low) && (high_included ? value <= high : value < high);
}

Usage::Usage(std::string tool, std::string purpose) : tool_(std::move(tool)), purpose_(std::move(purpose)) {}

Argument& Usage::add(Argument argument) {
    arguments_.push_back(std::move(argument));
    return arguments_.back();
}

Usage& Usage::input(const std::string& name, std::filesystem::path& target, const std::string& help) {
    add({Argument::Kind::input, name, help, true, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::inputs(const std::string& name, std::vector<std::filesystem::path>& target, const std::string& help) {
    add({Argument::Kind::inputs, name, help, true, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::input(const std::string& name, std::string& target,
                    std::function<std::vector<std::filesystem::path>(const std::string&)> files,
                    const std::string& help) {
    add({Argument::Kind::source, name, help, true, Unit::none, {}, {}, "", &target, std::move(files)});
    return *this;
}

Usage& Usage::output(const std::string& name, std::filesystem::path& target, const std::string& help) {
    add({Argument::Kind::output, name, help, true, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::optional_output(const std::string& name, std::filesystem::path& target, const std::string& help) {
    add({Argument::Kind::output, name, help, false, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::required(const std::string& flag, double& target, Unit unit, Range range, const std::string& help) {
    add({Argument::Kind::number, flag, help, true, unit, range, {}, "", &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, double& target, Unit unit, Range range, const std::string& help) {
    const std::string value = fmt::format("{:g}{}", target, unit == Unit::length ? "mm" : "");
    const std::string preset = range.contains(target) ? value : "";
    add({Argument::Kind::number, flag, help, false, unit, range, {}, preset, &target});
    return *this;
}

Usage& Usage::required(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help) {
    add({Argument::Kind::integer, flag, help, true, unit, range, {}, "", &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help) {
    const std::string preset = range.contains(static_cast<double>(target)) ? std::to_string(target) : "";
    add({Argument::Kind::integer, flag, help, false, unit, range, {}, preset, &target});
    return *this;
}

Usage& Usage::required(const std::string& flag, std::string& target, const std::string& help) {
    add({Argument::Kind::text, flag, help, true, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, std::string& target, const std::string& help) {
    add({Argument::Kind::text, flag, help, false, Unit::none, {}, {}, target, &target});
    return *this;
}

Usage& Usage::input_option(const std::string& flag, std::filesystem::path& target, const std::string& help) {
    add({Argument::Kind::input, flag, help, false, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::output_option(const std::string& flag, std::filesystem::path& target, const std::string& help) {
    add({Argument::Kind::output, flag, help, false, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::choice(const std::string& flag, std::string& target, const std::vector<std::string>& choices,
                     const std::string& help) {
    add({Argument::Kind::choice, flag, help, false, Unit::none, {}, choices, target, &target});
    return *this;
}

Usage& Usage::flag(const std::string& flag, bool& target, const std::string& help) {
    add({Argument::Kind::flag, flag, help, false, Unit::none, {}, {}, "", &target});
    return *this;
}

Usage& Usage::exclusive(const std::vector<std::string>& flags) {
    exclusives_.push_back(flags);
    return *this;
}

Usage& Usage::example(const std::string& command) {
    examples_.push_back(command);
    return *this;
}

bool positional(const Argument& argument) {
    return !argument.name.starts_with("--");
}

std::string help_text(const Usage& usage) {
    std::ostringstream out;
    out << usage.tool() << ": " << usage.purpose() << "\n\nusage: " << usage.tool();
    for (const auto& argument : usage.arguments())
        if (positional(argument))
            out << (argument.required ? " " : " [") << argument.name << (argument.required ? "" : "]")
                << (argument.kind == Argument::Kind::inputs ? "..." : "");
    for (const auto& argument : usage.arguments())
        if (!positional(argument) && argument.required) out << ' ' << argument.name << ' ' << value_name(argument);
    out << " [options]\n\n";
    std::vector<std::pair<std::string, std::string>> rows;
    for (const bool files : {true, false})
        for (const auto& argument : usage.arguments()) {
            if (positional(argument) != files) continue;
            const std::string value = files ? "" : value_name(argument);
            rows.emplace_back("  " + argument.name + (value.empty() ? "" : " " + value), full_help(argument));
        }
    rows.emplace_back("  --threads INTEGER", "threads to use [default: every core that this process may use]");
    rows.emplace_back("  --json FILE", "also write the results, units, time and memory as JSON");
    rows.emplace_back("  --quiet", "print errors only");
    rows.emplace_back("  --help", "print this text");
    rows.emplace_back("  --version", "print the version");
    std::size_t width = 0;
    for (const auto& row : rows) width = std::max(width, std::min<std::size_t>(row.first.size(), 34));
    for (const auto& [name, text] : rows) {
        out << name;
        if (name.size() > width)
            out << '\n' << std::string(width, ' ');
        else
            out << std::string(width - name.size(), ' ');
        out << "  " << text << '\n';
    }
    for (const auto& group : usage.exclusives())
        out << "\n" << fmt::format("At most one of {} may be given.\n", fmt::join(group, ", "));
    if (!usage.examples().empty()) {
        out << "\nexamples:\n";
        for (const auto& example : usage.examples()) out << "  " << example << '\n';
    }
    return out.str();
}

std::string reference_page(const Usage& usage) {
    std::ostringstream out;
    out << "## " << usage.tool() << "\n\n" << usage.purpose() << "\n\n| argument | what it is |\n|---|---|\n";
    for (const auto& argument : usage.arguments()) {
        std::string name = argument.name;
        if (!positional(argument) && argument.kind != Argument::Kind::flag)
            name += fmt::format(" {}", value_name(argument));
        std::string escaped;  // a bar would end the table's cell
        for (char c : name) {
            if (c == '|') escaped += '\\';
            escaped += c;
        }
        out << fmt::format("| `{}` | {} |\n", escaped, full_help(argument));
    }
    for (const auto& example : usage.examples()) out << "\n    " << example << '\n';
    return out.str();
}

}  // namespace tomodem::cli
