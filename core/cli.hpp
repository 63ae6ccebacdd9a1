#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "core/provenance.hpp"

/// The command line of every tool: usage declared once, and from it parsing, checks, `--help` and the reference page.
///
/// Every tool also takes --help, --version, --quiet, --threads and --json.
namespace tomodem::cli {

/// What a number on the command line measures. A length must carry its unit ("2.4um") and arrives in mm.
enum class Unit { none, length, strain, rate, fraction, percent, voxels, steps, particles };

/// Allowed values of a number; `text` says them in words for --help and for the error.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_included = true;
    bool high_included = true;
    std::string text() const;
    bool contains(double value) const;
};
inline constexpr Range any{};
inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), false, false};
inline constexpr Range not_negative{0, std::numeric_limits<double>::infinity(), true, false};

/// One option or argument, as --help, the completion of the docs and the parser see it.
struct Argument {
    enum class Kind { input, inputs, source, output, number, integer, text, choice, flag };
    Kind kind;
    std::string name;  // "--probe-radius", or the name of a positional argument
    std::string help;
    bool required = false;
    Unit unit = Unit::none;
    Range range;
    std::vector<std::string> choices;
    std::string default_text;
    void* target = nullptr;
    /// Of an input that is no plain path: the files that its text stands for; none: there is nothing like that.
    std::function<std::vector<std::filesystem::path>(const std::string&)> files = {};
};

class Usage {
 public:
    Usage(std::string tool, std::string purpose);

    /// An existing file or folder (checked), recorded with its digest in the provenance.
    Usage& input(const std::string& name, std::filesystem::path& target, const std::string& help);
    Usage& inputs(const std::string& name, std::vector<std::filesystem::path>& target, const std::string& help);
    /// An input that may be more than a path (a pattern, FILE:DATASET): `files` finds what it is made of.
    Usage& input(const std::string& name, std::string& target,
                 std::function<std::vector<std::filesystem::path>(const std::string&)> files, const std::string& help);
    /// A file to write; its folder must exist. Always the last positional argument.
    Usage& output(const std::string& name, std::filesystem::path& target, const std::string& help);
    /// The same, of a tool that has another name for it where none is given. Not for a tool with a list of inputs.
    Usage& optional_output(const std::string& name, std::filesystem::path& target, const std::string& help);

    /// The value that `target` holds is the default, named by --help; one outside the range stands for "not given".
    Usage& required(const std::string& flag, double& target, Unit unit, Range range, const std::string& help);
    Usage& option(const std::string& flag, double& target, Unit unit, Range range, const std::string& help);
    Usage& required(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help);
    Usage& option(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help);
    Usage& required(const std::string& flag, std::string& target, const std::string& help);
    Usage& option(const std::string& flag, std::string& target, const std::string& help);
    /// An optional extra file to read or write.
    Usage& input_option(const std::string& flag, std::filesystem::path& target, const std::string& help);
    Usage& output_option(const std::string& flag, std::filesystem::path& target, const std::string& help);
    Usage& choice(const std::string& flag, std::string& target, const std::vector<std::string>& choices,
                  const std::string& help);
    Usage& flag(const std::string& flag, bool& target, const std::string& help);
    /// Options of which at most one may be given.
    Usage& exclusive(const std::vector<std::string>& flags);
    Usage& example(const std::string& command);

    const std::string& tool() const { return tool_; }
    const std::string& purpose() const { return purpose_; }
    const std::vector<Argument>& arguments() const { return arguments_; }
    const std::vector<std::vector<std::string>>& exclusives() const { return exclusives_; }
    const std::vector<std::string>& examples() const { return examples_; }

 private:
    Argument& add(Argument argument);
    std::string tool_, purpose_;
    std::vector<Argument> arguments_;
    std::vector<std::vector<std::string>> exclusives_;
    std::vector<std::string> examples_;
};

/// Parses, runs, prints errors; returns the exit status (0 done, 1 failed, 2 wrong usage).
int run_tool(int argc, const char* const* argv, const Usage& usage, const std::function<void()>& run);

/// The whole main() of a tool: `return cli::main(argc, argv, usage, run);`
template <class Request>
int main(int argc, const char* const* argv, Usage (*usage)(Request&), void (*run)(const Request&)) {
    Request request;
    return run_tool(argc, argv, usage(request), [&] { run(request); });
}

/// True when `flag` ("--threshold") was given on the command line of the running tool.
bool given(const std::string& flag);

/// Threads that the running tool may use: --threads, or every core of this process' affinity.
int threads();

/// One result: printed on stdout (unless --quiet) and written to --json under `key` (snake_case), its unit beside it.
void report(const std::string& key, double value, const std::string& unit = "");
void report(const std::string& key, std::int64_t value, const std::string& unit = "");
void report(const std::string& key, const std::string& value);
/// A result that is a table or a list, as JSON text; goes to --json only.
void report_json(const std::string& key, const std::string& json);

/// A line for the user on stderr, hidden by --quiet. `warn` is shown always.
void note(const std::string& line);
void warn(const std::string& line);

/// Another input that the command line named within an option; its digest goes into the provenance.
void add_input(const std::string& name, const std::vector<std::filesystem::path>& files);

/// Version, command line, input digests of the running tool, to be stored in the files it writes.
Provenance provenance();

/// Nothing is printed or written by this process from here on (ranks of an MPI run other than the first).
void silence();

/// A progress bar on stderr with the time left, when stderr is a terminal and --quiet is not given.
class Progress {
 public:
    Progress(std::string label, double total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void update(double done);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem::cli
