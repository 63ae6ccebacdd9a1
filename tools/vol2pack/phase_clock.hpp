#pragma once
#include <fmt/format.h>

#include <chrono>
#include <string>

#include "core/cli.hpp"

namespace tomodem {

/// Wall time of the phases of a run, one after the other; they go to --json as `seconds`.
class PhaseClock {
 public:
    /// What happened since the last call, or since the clock was made.
    void done(const std::string& phase) {
        const auto now = std::chrono::steady_clock::now();
        table_ += fmt::format("{}\"{}\": {:.3f}", table_.empty() ? "" : ", ", phase,
                              std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }
    void report() const { cli::report_json("seconds", "{" + table_ + "}"); }

 private:
    std::string table_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace tomodem
