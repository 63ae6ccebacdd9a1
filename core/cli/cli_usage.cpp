#include "core/cli/cli_usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
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
    if (!argument.formats.empty()) text += fmt::format(" ({})", fmt::join(argument.formats, ", "));
    std::vector<std::string> remarks;
    if (!unit_text(argument.unit).empty()) remarks.push_back(unit_text(argument.unit));
    if (!argument.range.text().empty()) remarks.push_back(argument.range.text());
    if (argument.required && argument.name.starts_with("--")) remarks.push_back("required");
    if (!argument.default_text.empty()) remarks.push_back("default " + argument.default_text);
    if (!remarks.empty()) text += fmt::format(" [{}]", fmt::join(remarks, "; "));
    return text;
}

std::string at_most_one(const std::vector<std::string>& group) {
    return fmt::format("At most one of {} may be given.", fmt::join(group, ", "));
}

/// A bar would end the cell of a Markdown table.
std::string in_cell(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '|') escaped += '\\';
        escaped += c;
    }
    return escaped;
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

Usage& Usage::output(const std::string& name, std::filesystem::path& target, const std::string& help,
                     std::vector<std::string> formats) {
    add({Argument::Kind::output, name, help, true, Unit::none, {}, {}, "", &target, {}, std::move(formats)});
    return *this;
}

Usage& Usage::optional_output(const std::string& name, std::filesystem::path& target, const std::string& help,
                              std::vector<std::string> formats) {
    add({Argument::Kind::output, name, help, false, Unit::none, {}, {}, "", &target, {}, std::move(formats)});
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

Usage& Usage::output_option(const std::string& flag, std::filesystem::path& target, const std::string& help,
                            std::vector<std::string> formats) {
    add({Argument::Kind::output, flag, help, false, Unit::none, {}, {}, "", &target, {}, std::move(formats)});
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

Usage& Usage::threads() {
    threaded_ = true;
    return *this;
}

Usage& Usage::step(Step step) {
    step_ = step;
    return *this;
}

Usage& Usage::measure(Display display) {
    step_ = Step::measure;
    display_ = std::move(display);
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
    if (usage.threaded())
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
    for (const auto& group : usage.exclusives()) out << '\n' << at_most_one(group) << '\n';
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
        out << fmt::format("| `{}` | {} |\n", in_cell(name), in_cell(full_help(argument)));
    }
    for (const auto& group : usage.exclusives()) out << '\n' << at_most_one(group) << '\n';
    for (const auto& example : usage.examples()) out << "\n    " << example << '\n';
    return out.str();
}

namespace {

const char* name_of(Step step) {
    switch (step) {
        case Step::image:
            return "image";
        case Step::sample:
            return "sample";
        case Step::plan:
            return "plan";
        case Step::run:
            return "run";
        case Step::surface:
            return "surface";
        case Step::measure:
            return "measure";
        case Step::picture:
            return "picture";
    }
    return "";
}

const char* name_of(Argument::Kind kind) {
    using Kind = Argument::Kind;
    switch (kind) {
        case Kind::input:
        case Kind::source:
            return "input";
        case Kind::inputs:
            return "inputs";
        case Kind::output:
            return "output";
        case Kind::number:
            return "number";
        case Kind::integer:
            return "integer";
        case Kind::text:
            return "text";
        case Kind::choice:
            return "choice";
        case Kind::flag:
            return "flag";
    }
    return "";
}

nlohmann::ordered_json described(const Display::Quantity& quantity) {
    return {{"key", quantity.key}, {"label", quantity.label}, {"unit", quantity.unit}, {"factor", quantity.factor}};
}

}  // namespace

nlohmann::ordered_json description(const Display& display) {
    nlohmann::ordered_json result{{"heading", display.heading},
                                  {"results", nlohmann::ordered_json::array()},
                                  {"x", nullptr},
                                  {"curves", nlohmann::ordered_json::array()}};
    for (const auto& quantity : display.results) result["results"].push_back(described(quantity));
    if (!display.x.key.empty()) result["x"] = described(display.x);
    for (const auto& quantity : display.curves) result["curves"].push_back(described(quantity));
    return result;
}

nlohmann::ordered_json description(const Usage& usage) {
    nlohmann::ordered_json result{{"name", usage.tool()}, {"purpose", usage.purpose()}};
    result["step"] = usage.chain_step() ? nlohmann::ordered_json(name_of(*usage.chain_step())) : nullptr;
    result["threads"] = usage.threaded();
    auto& arguments = result["arguments"] = nlohmann::ordered_json::array();
    for (const Argument& argument : usage.arguments()) {
        nlohmann::ordered_json one{{"name", argument.name},
                                   {"kind", name_of(argument.kind)},
                                   {"required", argument.required},
                                   {"help", full_help(argument)}};
        if (!argument.formats.empty()) one["formats"] = argument.formats;
        if (!argument.choices.empty()) one["choices"] = argument.choices;
        arguments.push_back(std::move(one));
    }
    result["exclusive"] = usage.exclusives();
    result["examples"] = usage.examples();
    result["display"] = usage.display() ? description(*usage.display()) : nlohmann::ordered_json(nullptr);
    return result;
}

}  // namespace tomodem::cli
