#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/base/reporter.hpp"

/// The command line of every tool: usage declared once, and from it parsing, checks, `--help` and the reference page.
///
/// Every tool also takes --help, --version, --quiet and --json; --threads where the usage says so.
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
    /// Of an output: the extensions it accepts, as ".csv"; none: any name.
    std::vector<std::string> formats = {};
};

/// Where a tool stands in the chain; `tomodem` lists the tools in this order.
enum class Step { image, sample, plan, run, surface, measure, picture };

/// How pages (report, batch, cases) show a measure of a run. They know nothing else about it: a new measure appears on
/// them by what it declares here. --describe and the summary of --json hold it under `display`.
///
/// A result that a run does not have is left out of its summary. Of a table with a column `object`, each object has a
/// curve of its own; of one with a column `species`, the rows where it is empty are those of all particles.
struct Display {
    /// A number of the summary, or a column of the table.
    struct Quantity {
        std::string key;    ///< in the summary, or the column's name without its unit
        std::string label;  ///< as a page writes it: "flow stress"
        std::string unit;   ///< as a page writes it: "MPa"; empty: none
        double factor = 1;  ///< from the unit of the summary or the table to this one
    };
    std::string heading;            ///< "Stress and strain"
    std::vector<Quantity> results;  ///< of the summary, most important first
    Quantity x;                     ///< column of the plot's axis; an empty key: there is no plot
    std::vector<Quantity> curves;   ///< columns of the plot
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
    /// @param formats  the extensions that its name may have, as {".stl", ".ply"}; none: any name. --help lists them.
    Usage& output(const std::string& name, std::filesystem::path& target, const std::string& help,
                  std::vector<std::string> formats = {});
    /// The same, of a tool that has another name for it where none is given. Not for a tool with a list of inputs.
    Usage& optional_output(const std::string& name, std::filesystem::path& target, const std::string& help,
                           std::vector<std::string> formats = {});

    /// The value that `target` holds is the default, named by --help; one outside the range stands for "not given".
    Usage& required(const std::string& flag, double& target, Unit unit, Range range, const std::string& help);
    Usage& option(const std::string& flag, double& target, Unit unit, Range range, const std::string& help);
    Usage& required(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help);
    Usage& option(const std::string& flag, std::int64_t& target, Unit unit, Range range, const std::string& help);
    Usage& required(const std::string& flag, std::string& target, const std::string& help);
    Usage& option(const std::string& flag, std::string& target, const std::string& help);
    /// An optional extra file to read or write.
    Usage& input_option(const std::string& flag, std::filesystem::path& target, const std::string& help);
    Usage& output_option(const std::string& flag, std::filesystem::path& target, const std::string& help,
                         std::vector<std::string> formats = {});
    Usage& choice(const std::string& flag, std::string& target, const std::vector<std::string>& choices,
                  const std::string& help);
    Usage& flag(const std::string& flag, bool& target, const std::string& help);
    /// Options of which at most one may be given.
    Usage& exclusive(const std::vector<std::string>& flags);
    Usage& example(const std::string& command);
    /// The tool works on several threads: it accepts --threads.
    Usage& threads();
    Usage& step(Step step);
    /// The tool is a measure of a run that pages show so: called as TOOL RUN TABLE.
    Usage& measure(Display display);

    const std::string& tool() const { return tool_; }
    const std::string& purpose() const { return purpose_; }
    const std::vector<Argument>& arguments() const { return arguments_; }
    const std::vector<std::vector<std::string>>& exclusives() const { return exclusives_; }
    const std::vector<std::string>& examples() const { return examples_; }
    bool threaded() const { return threaded_; }
    const std::optional<Step>& chain_step() const { return step_; }
    const std::optional<Display>& display() const { return display_; }

 private:
    Argument& add(Argument argument);
    std::string tool_, purpose_;
    std::vector<Argument> arguments_;
    std::vector<std::vector<std::string>> exclusives_;
    std::vector<std::string> examples_;
    bool threaded_ = false;
    std::optional<Step> step_;
    std::optional<Display> display_;
};

/// Whether a process prints and writes its summary: of an MPI run the first one alone does.
enum class Voice { heard, silent };

/// The running tool: what its command line said, and the way to its user. main hands it to `run`; nothing below does
/// more with it than report, as a Reporter.
class Tool final : public Reporter {
 public:
    Tool(const Usage& usage, int argc, const char* const* argv, Voice voice);

    /// True when `flag` ("--threshold") was given on the command line.
    bool given(const std::string& flag) const { return given_.contains(flag); }
    /// Threads to use: --threads, or every core of this process' affinity.
    int threads() const;

    /// One result: printed on stdout (unless --quiet) and written to --json under `key` (snake_case), its unit beside
    /// it.
    void report(const std::string& key, double value, const std::string& unit = "") override;
    void report(const std::string& key, std::int64_t value, const std::string& unit = "") override;
    void report(const std::string& key, const std::string& value) override;
    /// A result that is a table or a list; it goes to --json only.
    void report_json(const std::string& key, const nlohmann::ordered_json& value) override;

    /// A list that is the tool's answer: printed on stdout line by line, without the key.
    void report_lines(const std::string& key, const std::vector<std::string>& lines);

    /// A line on stderr, hidden by --quiet. `warn` is shown always.
    void note(const std::string& line) override;
    void warn(const std::string& line) override;
    /// A bar on stderr with the time left, when stderr is a terminal and --quiet is not given.
    std::unique_ptr<Progress> progress(const std::string& label, double total) override;

    /// Another input that the command line named within an option; its digest goes into the provenance.
    void add_input(const std::string& name, const std::vector<std::filesystem::path>& files);
    /// Version, command line, input digests, to be stored in the files that the tool writes.
    Provenance provenance() const;

 private:
    friend int run_tool(int, const char* const*, const Usage&, const std::function<void(Tool&)>&, Voice);
    friend bool parse(Tool&, int, const char* const*, const Usage&);
    template <class Value>
    void add_result(const std::string& key, const Value& value, const std::string& unit);
    int fail(int status, const std::string& message) const;
    void write_summary(double wall_seconds) const;

    std::string name_;
    bool quiet_ = false, silent_ = false;
    std::int64_t threads_ = 0;  ///< 0: not given
    std::filesystem::path json_;
    std::set<std::string> given_;
    std::map<std::string, std::vector<std::filesystem::path>> inputs_;  ///< the files of each input, by its name
    Provenance provenance_;
    std::optional<Display> display_;
    struct Results;
    std::shared_ptr<Results> results_;
};

/// Parses, runs, prints errors; returns the exit status (0 done, 1 failed, 2 wrong usage).
int run_tool(int argc, const char* const* argv, const Usage& usage, const std::function<void(Tool&)>& run,
             Voice voice = Voice::heard);

/// The whole main() of a tool: `return cli::main(argc, argv, usage, run);`
template <class Request>
int main(int argc, const char* const* argv, Usage (*usage)(Request&), void (*run)(const Request&, Tool&),
         Voice voice = Voice::heard) {
    Request request;
    return run_tool(
        argc, argv, usage(request), [&](Tool& tool) { run(request, tool); }, voice);
}

}  // namespace tomodem::cli
