#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/cli/cli.hpp"
#include "core/cli/help.hpp"

namespace tomodem::cli {

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
    const auto small = [](char c) { return (c < 'A' || c > 'Z') && (c < '0' || c > '9') && c != '_'; };
    if (positional(argument) && std::any_of(argument.name.begin(), argument.name.end(), small))
        throw std::logic_error(
            fmt::format("{}: the name of the positional argument {} must be in capitals", tool_, argument.name));
    arguments_.push_back(std::move(argument));
    return arguments_.back();
}

Usage& Usage::input(const std::string& name, std::filesystem::path& target, const std::string& help) {
    add({.kind = Argument::Kind::input, .name = name, .help = help, .required = true, .target = &target});
    return *this;
}

Usage& Usage::inputs(const std::string& name, std::vector<std::filesystem::path>& target, const std::string& help) {
    add({.kind = Argument::Kind::inputs, .name = name, .help = help, .required = true, .target = &target});
    return *this;
}

Usage& Usage::input(const std::string& name, std::string& target,
                    std::function<std::vector<std::filesystem::path>(const std::string&)> files,
                    const std::string& help) {
    add({.kind = Argument::Kind::source,
         .name = name,
         .help = help,
         .required = true,
         .target = &target,
         .files = std::move(files)});
    return *this;
}

Usage& Usage::output(const std::string& name, std::filesystem::path& target, const std::string& help,
                     std::vector<std::string> formats) {
    add({.kind = Argument::Kind::output,
         .name = name,
         .help = help,
         .required = true,
         .target = &target,
         .formats = std::move(formats)});
    return *this;
}

Usage& Usage::optional_output(const std::string& name, std::filesystem::path& target, const std::string& help,
                              std::vector<std::string> formats) {
    add({.kind = Argument::Kind::output, .name = name, .help = help, .target = &target, .formats = std::move(formats)});
    return *this;
}

Usage& Usage::required(const std::string& flag, double& target, Unit unit, Range range, const std::string& help) {
    add({.kind = Argument::Kind::number,
         .name = flag,
         .help = help,
         .required = true,
         .unit = unit,
         .range = range,
         .target = &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, double& target, Unit unit, Range range, const std::string& help) {
    const std::string value = fmt::format("{:g}{}", target, unit == Unit::length ? "mm" : "");
    const std::string preset = range.contains(target) ? value : "";
    add({.kind = Argument::Kind::number,
         .name = flag,
         .help = help,
         .unit = unit,
         .range = range,
         .default_text = preset,
         .target = &target});
    return *this;
}

Usage& Usage::required(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help) {
    add({.kind = Argument::Kind::integer,
         .name = flag,
         .help = help,
         .required = true,
         .unit = unit,
         .range = range,
         .target = &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help) {
    const std::string preset = range.contains(static_cast<double>(target)) ? std::to_string(target) : "";
    add({.kind = Argument::Kind::integer,
         .name = flag,
         .help = help,
         .unit = unit,
         .range = range,
         .default_text = preset,
         .target = &target});
    return *this;
}

Usage& Usage::required(const std::string& flag, std::string& target, const std::string& help) {
    add({.kind = Argument::Kind::text, .name = flag, .help = help, .required = true, .target = &target});
    return *this;
}

Usage& Usage::option(const std::string& flag, std::string& target, const std::string& help) {
    add({.kind = Argument::Kind::text, .name = flag, .help = help, .default_text = target, .target = &target});
    return *this;
}

Usage& Usage::input_option(const std::string& flag, std::filesystem::path& target, const std::string& help) {
    add({.kind = Argument::Kind::input, .name = flag, .help = help, .target = &target});
    return *this;
}

Usage& Usage::output_option(const std::string& flag, std::filesystem::path& target, const std::string& help,
                            std::vector<std::string> formats) {
    add({.kind = Argument::Kind::output, .name = flag, .help = help, .target = &target, .formats = std::move(formats)});
    return *this;
}

Usage& Usage::choice(const std::string& flag, std::string& target, const std::vector<std::string>& choices,
                     const std::string& help) {
    add({.kind = Argument::Kind::choice,
         .name = flag,
         .help = help,
         .choices = choices,
         .default_text = target,
         .target = &target});
    return *this;
}

Usage& Usage::flag(const std::string& flag, bool& target, const std::string& help) {
    add({.kind = Argument::Kind::flag, .name = flag, .help = help, .target = &target});
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

}  // namespace tomodem::cli
