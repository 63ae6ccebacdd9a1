#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/output_file.hpp"
#include "core/base/version.hpp"
#include "core/cli/cli.hpp"
#include "core/cli/help.hpp"

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
    if (line_.threads > 0) return static_cast<int>(line_.threads);
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
    return 1;
}

template <class Value>
void Tool::add_result(const std::string& key, const Value& value, const std::string& unit) {
    results_->values[key] = value;
    if (!unit.empty()) results_->units[key] = unit;
    if (line_.quiet || silent_) return;
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
    if (line_.quiet || silent_) return;
    for (const std::string& line : lines) std::printf("%s\n", line.c_str());
}

void Tool::note(const std::string& line) {
    if (!line_.quiet && !silent_) std::fprintf(stderr, "%s: %s\n", name_.c_str(), line.c_str());
}

void Tool::warn(const std::string& line) {
    if (!silent_) std::fprintf(stderr, "%s: warning: %s\n", name_.c_str(), line.c_str());
}

std::unique_ptr<Progress> Tool::progress(const std::string& label, double total) {
    return std::make_unique<ProgressBar>(label, total, isatty(STDERR_FILENO) != 0 && !line_.quiet && !silent_);
}

void Tool::add_input(const std::string& name, const std::vector<std::filesystem::path>& files) {
    line_.inputs[name] = files;
}

Provenance Tool::provenance() const {
    Provenance result = provenance_;
    for (const auto& [name, files] : line_.inputs) result.inputs[name] = content_digest(files);
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
    write_text(line_.json, summary.dump(2) + "\n");
}

int run_tool(int argc, const char* const* argv, const Usage& usage, const std::function<void(Tool&)>& run,
             Voice voice) {
    Tool tool(usage, argc, argv, voice);
    try {
        const auto start = std::chrono::steady_clock::now();
        tool.line_ = parse(usage, argc, argv);
        // --threads bounds every library that runs on TBB, and may ask for more threads than there are cores.
        std::optional<tbb::global_control> limit;
        if (usage.threaded())
            limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(tool.threads()));
        if (tool.line_.answer.empty()) run(tool);
        std::fputs(tool.line_.answer.c_str(), stdout);
        if (!tool.line_.json.empty() && !tool.silent_)
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
