#include "core/cli/cli.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/output_file.hpp"
#include "core/base/units.hpp"
#include "core/base/version.hpp"
#include "core/cli/cli_usage.hpp"

namespace tomodem::cli {
namespace {

std::string shell_quoted(const std::string& word) {
    static const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
    std::string quoted;
    for (char c : word) {
        if (c == '\'')
            quoted += "'\\''";
        else
            quoted += c;
    }
    return fmt::format("'{}'", quoted);
}

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
    if (!std::filesystem::exists(path))
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

/// A name that promises another format than those written.
void check_format(const Argument& argument, const std::filesystem::path& path) {
    const auto& formats = argument.formats;
    if (!formats.empty() && std::find(formats.begin(), formats.end(), path.extension().string()) == formats.end())
        throw WrongUsage(
            fmt::format("{} '{}': the name must end in {}", argument.name, path.string(), fmt::join(formats, " or ")));
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

}  // namespace

/// Splits the command line with CLI11 and stores every value; false when --help or --version was answered.
bool parse(Tool& tool, int argc, const char* const* argv, const Usage& usage) {
    CLI::App app{usage.purpose(), usage.tool()};
    app.set_help_flag();
    bool help = false, version = false, markdown = false, describe = false;
    std::string threads_text, json_text;
    app.add_flag("--help,-h", help);
    app.add_flag("--version", version);
    app.add_flag("--help-markdown", markdown);
    app.add_flag("--describe", describe);
    app.add_flag("--quiet", tool.quiet_);
    if (usage.threaded()) app.add_option("--threads", threads_text);
    app.add_option("--json", json_text);

    const auto& arguments = usage.arguments();
    std::vector<std::vector<std::string>> words(arguments.size());
    std::vector<bool> flags(arguments.size());
    std::vector<CLI::Option*> options(arguments.size());
    std::vector<std::string> positionals;
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        if (positional(arguments[k])) continue;
        if (arguments[k].kind == Argument::Kind::flag)
            options[k] = app.add_flag(arguments[k].name);
        else
            options[k] = app.add_option(arguments[k].name, words[k])->expected(1)->allow_extra_args(false);
    }
    app.add_option("files", positionals);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        throw WrongUsage(fmt::format("{}; see {} --help", error.what(), usage.tool()));
    }
    if (help || version || markdown || describe) {
        const std::string text = help       ? help_text(usage)
                                 : markdown ? reference_page(usage)
                                 : describe ? description(usage).dump(2) + "\n"
                                            : fmt::format("{} (tomodem) {}\n", usage.tool(), TOMODEM_VERSION);
        std::fputs(text.c_str(), stdout);
        return false;
    }

    std::size_t before_list = 0, after_list = 0, optional = 0;
    bool has_list = false;
    for (const auto& argument : arguments) {
        if (!positional(argument)) continue;
        if (!argument.required) {
            ++optional;
            continue;
        }
        if (argument.kind == Argument::Kind::inputs)
            has_list = true;
        else
            ++(has_list ? after_list : before_list);
    }
    const std::size_t least = before_list + after_list + (has_list ? 1 : 0);
    if (positionals.size() < least || (!has_list && positionals.size() > least + optional)) {
        std::vector<std::string> names;
        for (const auto& argument : arguments)
            if (positional(argument)) names.push_back(argument.name);
        throw WrongUsage(
            fmt::format("expected {} ({}) but got {}; see {} --help",
                        least == 1 ? "one file" : fmt::format("{}{} files", has_list ? "at least " : "", least),
                        fmt::join(names, ", "), positionals.size(), usage.tool()));
    }
    std::size_t next = 0;
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        if (!positional(arguments[k])) {
            flags[k] = options[k]->count() > 0;
            if (flags[k])
                tool.given_.insert(arguments[k].name);
            else if (arguments[k].required)
                throw WrongUsage(fmt::format("{} is required ({}); see {} --help", arguments[k].name, arguments[k].help,
                                             usage.tool()));
            if (flags[k] && arguments[k].kind == Argument::Kind::flag) words[k] = {"true"};
            continue;
        }
        if (!arguments[k].required && next == positionals.size()) continue;
        std::size_t count = 1;
        if (arguments[k].kind == Argument::Kind::inputs) count = positionals.size() - before_list - after_list;
        words[k].assign(positionals.begin() + next, positionals.begin() + next + count);
        next += count;
    }
    for (const auto& group : usage.exclusives()) {
        std::vector<std::string> found;
        for (const auto& flag : group)
            if (tool.given_.contains(flag)) found.push_back(flag);
        if (found.size() > 1)
            throw WrongUsage(fmt::format("{} exclude each other; give one of them", fmt::join(found, " and ")));
    }
    // Ranges first, then files: a wrong option is reported even where the file is missing too.
    const auto is_file = [](const Argument& a) {
        return a.kind == Argument::Kind::input || a.kind == Argument::Kind::inputs ||
               a.kind == Argument::Kind::source || a.kind == Argument::Kind::output;
    };
    for (bool files : {false, true})
        for (std::size_t k = 0; k < arguments.size(); ++k)
            if (!words[k].empty() && is_file(arguments[k]) == files) store(arguments[k], words[k]);

    for (std::size_t k = 0; k < arguments.size(); ++k) {
        if (arguments[k].kind == Argument::Kind::source && !words[k].empty())
            tool.inputs_[words[k].front()] = arguments[k].files(words[k].front());
        if (arguments[k].kind == Argument::Kind::input || arguments[k].kind == Argument::Kind::inputs)
            for (const auto& word : words[k]) tool.inputs_[word] = {word};
    }
    check_overwriting(tool.inputs_, arguments, words, json_text);

    if (!threads_text.empty())
        tool.threads_ = parse_integer(
            {Argument::Kind::integer, "--threads", "", false, Unit::none, {1, 4096}, {}, "", nullptr}, threads_text);
    if (!json_text.empty()) {
        tool.json_ = json_text;
        check_output({Argument::Kind::output, "--json", "", false, Unit::none, {}, {}, "", nullptr}, tool.json_);
    }
    return true;
}

namespace {

double cpu_seconds() {
    rusage own{};
    getrusage(RUSAGE_SELF, &own);
    const auto seconds = [](const timeval& t) { return t.tv_sec + 1e-6 * t.tv_usec; };
    return seconds(own.ru_utime) + seconds(own.ru_stime);
}

std::int64_t peak_bytes() {
    rusage own{};
    getrusage(RUSAGE_SELF, &own);
    return own.ru_maxrss * 1024;
}

std::string duration_text(double seconds) {
    const auto all = static_cast<std::int64_t>(std::llround(seconds));
    if (all < 120) return fmt::format("{} s", all);
    if (all < 120 * 60) return fmt::format("{} min", (all + 30) / 60);
    return fmt::format("{} h {:02} min", all / 3600, all % 3600 / 60);
}

class ProgressBar final : public Progress {
 public:
    ProgressBar(std::string label, double total, bool shown)
        : label_(std::move(label)),
          total_(total),
          shown_(shown),
          start_(Clock::now()),
          last_(start_ - std::chrono::hours(1)) {}
    ~ProgressBar() override {
        if (shown_) std::fputs("\r\033[K", stderr);
    }
    void update(double done) override {
        using namespace std::chrono;
        const auto now = Clock::now();
        if (!shown_ || now - last_ < milliseconds(200)) return;
        last_ = now;
        const double share = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 0;
        const double elapsed = duration<double>(now - start_).count();
        constexpr int width = 30;
        const int filled = static_cast<int>(share * width);
        const std::string left = share > 0.01 ? duration_text(elapsed * (1 - share) / share) + " left" : "";
        std::fprintf(stderr, "\r\033[K%s [%s%s] %3.0f %% %s", label_.c_str(), std::string(filled, '#').c_str(),
                     std::string(width - filled, '.').c_str(), 100 * share, left.c_str());
        std::fflush(stderr);
    }

 private:
    using Clock = std::chrono::steady_clock;
    std::string label_;
    double total_;
    bool shown_;
    Clock::time_point start_, last_;
};

}  // namespace

struct Tool::Results {
    nlohmann::ordered_json values, units = nlohmann::ordered_json::object();
};

Tool::Tool(const Usage& usage, int argc, const char* const* argv, Voice voice)
    : name_(usage.tool()),
      silent_(voice == Voice::silent),
      display_(usage.display()),
      results_(std::make_shared<Results>()) {
    provenance_.tool = usage.tool();
    provenance_.version = TOMODEM_VERSION;
    std::vector<std::string> words;
    for (int k = 0; k < argc; ++k)
        words.push_back(shell_quoted(k == 0 ? std::filesystem::path(argv[0]).filename().string() : argv[k]));
    provenance_.command_line = fmt::format("{}", fmt::join(words, " "));
}

int Tool::threads() const {
    if (threads_ > 0) return static_cast<int>(threads_);
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
    return 1;
}

template <class Value>
void Tool::add_result(const std::string& key, const Value& value, const std::string& unit) {
    results_->values[key] = value;
    if (!unit.empty()) results_->units[key] = unit;
    if (quiet_ || silent_) return;
    std::string shown;
    if constexpr (std::is_same_v<Value, double>)
        shown = fmt::format("{:.6g}", value);
    else
        shown = fmt::format("{}", value);
    std::printf("%s: %s%s%s\n", key.c_str(), shown.c_str(), unit.empty() ? "" : " ", unit.c_str());
}

void Tool::report(const std::string& key, double value, const std::string& unit) {
    add_result(key, value, unit);
}
void Tool::report(const std::string& key, std::int64_t value, const std::string& unit) {
    add_result(key, value, unit);
}
void Tool::report(const std::string& key, const std::string& value) {
    add_result(key, value, "");
}

void Tool::report_json(const std::string& key, const nlohmann::ordered_json& value) {
    results_->values[key] = value;
}

void Tool::report_lines(const std::string& key, const std::vector<std::string>& lines) {
    results_->values[key] = lines;
    if (quiet_ || silent_) return;
    for (const std::string& line : lines) std::printf("%s\n", line.c_str());
}

void Tool::note(const std::string& line) {
    if (!quiet_ && !silent_) std::fprintf(stderr, "%s: %s\n", name_.c_str(), line.c_str());
}

void Tool::warn(const std::string& line) {
    if (!silent_) std::fprintf(stderr, "%s: warning: %s\n", name_.c_str(), line.c_str());
}

std::unique_ptr<Progress> Tool::progress(const std::string& label, double total) {
    return std::make_unique<ProgressBar>(label, total, isatty(STDERR_FILENO) != 0 && !quiet_ && !silent_);
}

void Tool::add_input(const std::string& name, const std::vector<std::filesystem::path>& files) {
    inputs_[name] = files;
}

Provenance Tool::provenance() const {
    Provenance result = provenance_;
    for (const auto& [name, files] : inputs_) result.inputs[name] = content_digest(files);
    return result;
}

int Tool::fail(int status, const std::string& message) const {
    if (!silent_) std::fprintf(stderr, "%s: %s\n", name_.c_str(), message.c_str());
    return status;
}

void Tool::write_summary(double wall_seconds) const {
    nlohmann::ordered_json summary;
    summary["tool"] = name_;
    summary["version"] = provenance_.version;
    summary["command_line"] = provenance_.command_line;
    summary["wall_seconds"] = wall_seconds;
    summary["cpu_seconds"] = cpu_seconds();
    summary["peak_bytes"] = peak_bytes();
    for (const auto& [key, value] : results_->values.items()) summary[key] = value;
    summary["units"] = results_->units;
    if (display_) summary["display"] = description(*display_);
    write_text(json_, summary.dump(2) + "\n");
}

int run_tool(int argc, const char* const* argv, const Usage& usage, const std::function<void(Tool&)>& run,
             Voice voice) {
    Tool tool(usage, argc, argv, voice);
    try {
        const auto start = std::chrono::steady_clock::now();
        if (!parse(tool, argc, argv, usage)) return 0;
        run(tool);
        if (!tool.json_.empty() && !tool.silent_)
            tool.write_summary(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        if (std::fflush(stdout) != 0) return tool.fail(1, "cannot write to standard output");
        return 0;
    } catch (const WrongUsage& error) {
        return tool.fail(2, error.what());
    } catch (const std::bad_alloc&) {
        return tool.fail(1, "out of memory; use fewer particles or a machine with more");
    } catch (const std::exception& error) {
        return tool.fail(1, error.what());
    }
}

}  // namespace tomodem::cli
