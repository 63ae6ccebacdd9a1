#include "core/cli/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/units.hpp"
#include "core/base/version.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/help.hpp"

namespace tomodem::cli {
namespace {

double parse_number(const Argument& argument, const std::string& text) {
    double value = 0;
    if (argument.unit == Unit::length) {
        try {
            value = units::length(text);
        } catch (const InvalidInput& error) {
            throw WrongUsage(fmt::format("{}: {}", argument.name, error.what()));
        }
    } else {
        std::string digits = text;
        if (argument.unit == Unit::percent && !digits.empty() && digits.back() == '%') digits.pop_back();
        char* end = nullptr;
        value = std::strtod(digits.c_str(), &end);
        if (argument.unit == Unit::percent && text == digits && value > 0 && value < 1)
            throw WrongUsage(
                fmt::format("{} {}: is that {}% or {:g}%? write the % sign", argument.name, text, text, 100 * value));
        if (digits.empty() || *end != '\0' || !std::isfinite(value))
            throw WrongUsage(fmt::format("{} '{}' is not a number", argument.name, text));
    }
    if (!argument.range.contains(value))
        throw WrongUsage(fmt::format("{} {} is out of range: expected {}", argument.name, text, argument.range.text()));
    return value;
}

std::int64_t parse_integer(const Argument& argument, const std::string& text) {
    // "1e6" is how people write a particle count.
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || value != std::floor(value) || std::abs(value) > 9e15)
        throw WrongUsage(fmt::format("{} '{}' is not a whole number", argument.name, text));
    if (!argument.range.contains(value))
        throw WrongUsage(fmt::format("{} {} is out of range: expected {}", argument.name, text, argument.range.text()));
    return static_cast<std::int64_t>(value);
}

void check_input(const Argument& argument, const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return;
    // What solve keeps of a run until it is complete (docs/running.md).
    if (const std::string partial = path.string() + ".partial"; std::filesystem::exists(partial))
        throw InvalidInput(
            fmt::format("cannot read {} '{}': this run is unfinished; give '{}', which holds what it has written so "
                        "far, or let it end (if solve has stopped, repeat its command with --resume)",
                        argument.name, path.string(), partial));
    throw InvalidInput(
        fmt::format("cannot read {} '{}': there is no such file or folder", argument.name, path.string()));
}

void check_output(const Argument& argument, const std::filesystem::path& path) {
    if (std::filesystem::is_directory(path))
        throw InvalidInput(
            fmt::format("cannot write {} '{}': it is a folder; give the name of a file", argument.name, path.string()));
    std::filesystem::path folder = path.parent_path();
    if (folder.empty()) folder = ".";
    if (!std::filesystem::is_directory(folder))
        throw InvalidInput(fmt::format("cannot write {} '{}': folder '{}' does not exist; create it first",
                                       argument.name, path.string(), folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
        throw InvalidInput(fmt::format("cannot write {} '{}': no permission to write in folder '{}'", argument.name,
                                       path.string(), folder.string()));
}

/// Extensions that promise a format; what stands behind any other name is the user's choice.
constexpr std::array known_formats{".csv", ".h5",  ".hdf5", ".html", ".json", ".mp4", ".obj", ".ply",
                                   ".png", ".pvd", ".stl",  ".tif",  ".toml", ".vtp", ".xdmf"};

/// A name that promises another format than those written.
void check_format(const Argument& argument, const std::filesystem::path& path) {
    const auto& written = argument.formats;
    const std::string extension = path.extension().string();
    const auto holds_it = [&](const auto& formats) {
        return std::find(formats.begin(), formats.end(), extension) != formats.end();
    };
    if (!written.empty() && holds_it(known_formats) && !holds_it(written))
        throw WrongUsage(
            fmt::format("{} '{}': the name must end in {}", argument.name, path.string(), fmt::join(written, " or ")));
}

/// Two results in one file: the first would be lost.
void check_same_output(const std::vector<std::pair<std::string, std::string>>& outputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (std::filesystem::absolute(outputs[i].second).lexically_normal() ==
                std::filesystem::absolute(outputs[j].second).lexically_normal())
                throw WrongUsage(fmt::format("{} and {} are both '{}'; give each result a file of its own",
                                             outputs[j].first, outputs[i].first, outputs[i].second));
}

/// A result that would take the place of what it is made from is a slip.
void check_overwriting(const std::map<std::string, std::vector<std::filesystem::path>>& inputs,
                       const std::vector<Argument>& arguments, const std::vector<std::vector<std::string>>& words,
                       const std::string& json) {
    const auto check = [&](const std::string& name, const std::string& path) {
        std::error_code ignored;
        for (const auto& [input, files] : inputs)
            for (const auto& file : files)
                if (std::filesystem::equivalent(file, path, ignored))
                    throw InvalidInput(
                        fmt::format("{} '{}' is also an input, which would be lost; give it another name", name, path));
    };
    std::vector<std::pair<std::string, std::string>> outputs;
    for (std::size_t k = 0; k < arguments.size(); ++k)
        if (arguments[k].kind == Argument::Kind::output && !words[k].empty())
            outputs.emplace_back(arguments[k].name, words[k].front());
    if (!json.empty()) outputs.emplace_back("--json", json);
    for (const auto& [name, path] : outputs) check(name, path);
    check_same_output(outputs);
}

void store(const Argument& argument, const std::vector<std::string>& words) {
    using Kind = Argument::Kind;
    const std::string& word = words.front();
    switch (argument.kind) {
        case Kind::input: {
            const std::filesystem::path path = word;
            check_input(argument, path);
            *static_cast<std::filesystem::path*>(argument.target) = path;
            break;
        }
        case Kind::inputs: {
            auto& paths = *static_cast<std::vector<std::filesystem::path>*>(argument.target);
            for (const auto& name : words) {
                check_input(argument, name);
                paths.emplace_back(name);
            }
            break;
        }
        case Kind::source:
            if (argument.files(word).empty())
                throw InvalidInput(
                    fmt::format("cannot read {} '{}': there is no such file or folder", argument.name, word));
            *static_cast<std::string*>(argument.target) = word;
            break;
        case Kind::output: {
            const std::filesystem::path path = word;
            check_output(argument, path);
            check_format(argument, path);
            *static_cast<std::filesystem::path*>(argument.target) = path;
            break;
        }
        case Kind::number:
            *static_cast<double*>(argument.target) = parse_number(argument, word);
            break;
        case Kind::integer:
            *static_cast<std::int64_t*>(argument.target) = parse_integer(argument, word);
            break;
        case Kind::choice:
            if (std::find(argument.choices.begin(), argument.choices.end(), word) == argument.choices.end())
                throw WrongUsage(
                    fmt::format("{} '{}' is not one of {}", argument.name, word, fmt::join(argument.choices, ", ")));
            [[fallthrough]];
        case Kind::text:
            *static_cast<std::string*>(argument.target) = word;
            break;
        case Kind::flag:
            *static_cast<bool*>(argument.target) = true;
            break;
    }
}

bool is_file(const Argument& argument) {
    using Kind = Argument::Kind;
    return argument.kind == Kind::input || argument.kind == Kind::inputs || argument.kind == Kind::source ||
           argument.kind == Kind::output;
}

/// The command line, split but not understood.
struct Words {
    std::vector<std::vector<std::string>> of;  ///< of each argument of the usage; empty: not given
    std::vector<std::string> positionals, json, threads;
};

/// Splits the command line with CLI11; fills in `line` as far as no value has to be understood.
Words split(const Usage& usage, int argc, const char* const* argv, CommandLine& line) {
    const auto& arguments = usage.arguments();
    Words words;
    words.of.resize(arguments.size());
    CLI::App app{usage.purpose(), usage.tool()};
    app.set_help_flag();
    bool help = false, version = false, markdown = false, describe = false;
    app.add_flag("--help,-h", help);
    app.add_flag("--version", version);
    app.add_flag("--help-markdown", markdown);
    app.add_flag("--describe", describe);
    app.add_flag("--quiet", line.quiet);
    const auto add_option = [&](const std::string& name, std::vector<std::string>& target) {
        return app.add_option(name, target)->expected(1)->allow_extra_args(false);
    };
    if (usage.threaded()) add_option("--threads", words.threads);
    add_option("--json", words.json);
    std::vector<CLI::Option*> options(arguments.size());
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        if (positional(arguments[k])) continue;
        options[k] = arguments[k].kind == Argument::Kind::flag ? app.add_flag(arguments[k].name)
                                                               : add_option(arguments[k].name, words.of[k]);
    }
    app.add_option("files", words.positionals);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        throw WrongUsage(fmt::format("{}; see {} --help", error.what(), usage.tool()));
    }
    if (help)
        line.answer = help_text(usage);
    else if (markdown)
        line.answer = reference_page(usage);
    else if (describe)
        line.answer = description(usage).dump(2) + "\n";
    else if (version)
        line.answer = fmt::format("{} (tomodem) {}\n", usage.tool(), TOMODEM_VERSION);
    for (std::size_t k = 0; k < arguments.size(); ++k)
        if (options[k] != nullptr && options[k]->count() > 0) {
            line.given.insert(arguments[k].name);
            if (arguments[k].kind == Argument::Kind::flag) words.of[k] = {"true"};
        }
    return words;
}

/// Gives each positional argument its words: one, or what the others leave to a list.
void place_positionals(const Usage& usage, Words& words) {
    std::size_t before_list = 0, after_list = 0, optional = 0;
    bool has_list = false;
    std::vector<std::string> names;
    for (const auto& argument : usage.arguments()) {
        if (!positional(argument)) continue;
        names.push_back(argument.name);
        if (!argument.required)
            ++optional;
        else if (argument.kind == Argument::Kind::inputs)
            has_list = true;
        else
            ++(has_list ? after_list : before_list);
    }
    const std::size_t given = words.positionals.size();
    const std::size_t min_count = before_list + after_list + (has_list ? 1 : 0);
    if (given < min_count || (!has_list && given > min_count + optional))
        throw WrongUsage(
            fmt::format("expected {} ({}) but got {}; see {} --help",
                        min_count == 1 ? "one file" : fmt::format("{}{} files", has_list ? "at least " : "", min_count),
                        fmt::join(names, ", "), given, usage.tool()));
    auto next = words.positionals.begin();
    for (std::size_t k = 0; k < usage.arguments().size(); ++k) {
        const Argument& argument = usage.arguments()[k];
        if (!positional(argument) || (!argument.required && next == words.positionals.end())) continue;
        const std::size_t count = argument.kind == Argument::Kind::inputs ? given - before_list - after_list : 1;
        words.of[k].assign(next, next + static_cast<std::ptrdiff_t>(count));
        next += static_cast<std::ptrdiff_t>(count);
    }
}

void check_options(const Usage& usage, const std::set<std::string>& given) {
    for (const auto& argument : usage.arguments())
        if (!positional(argument) && argument.required && !given.contains(argument.name))
            throw WrongUsage(fmt::format("{} is required; see {} --help", argument.name, usage.tool()));
    for (const auto& group : usage.exclusives()) {
        std::vector<std::string> found;
        for (const auto& flag : group)
            if (given.contains(flag)) found.push_back(flag);
        if (found.size() > 1)
            throw WrongUsage(fmt::format("{} exclude each other; give one of them", fmt::join(found, " and ")));
    }
}

}  // namespace

CommandLine parse(const Usage& usage, int argc, const char* const* argv) {
    CommandLine line;
    Words words = split(usage, argc, argv, line);
    if (!line.answer.empty()) return line;
    place_positionals(usage, words);
    check_options(usage, line.given);

    const auto& arguments = usage.arguments();
    // Ranges first, then files: a wrong option is reported even where the file is missing too.
    for (const bool files : {false, true})
        for (std::size_t k = 0; k < arguments.size(); ++k)
            if (!words.of[k].empty() && is_file(arguments[k]) == files) store(arguments[k], words.of[k]);
    for (std::size_t k = 0; k < arguments.size(); ++k)
        for (const auto& word : words.of[k]) {
            if (arguments[k].kind == Argument::Kind::source) line.inputs[word] = arguments[k].files(word);
            if (arguments[k].kind == Argument::Kind::input || arguments[k].kind == Argument::Kind::inputs)
                line.inputs[word] = {word};
        }
    const std::string json = words.json.empty() ? "" : words.json.front();
    check_overwriting(line.inputs, arguments, words.of, json);
    if (!words.threads.empty())
        line.threads = parse_integer({.kind = Argument::Kind::integer, .name = "--threads", .range = {1, 4096}},
                                     words.threads.front());
    if (!json.empty()) {
        line.json = json;
        check_output({.kind = Argument::Kind::output, .name = "--json"}, line.json);
    }
    return line;
}

}  // namespace tomodem::cli
