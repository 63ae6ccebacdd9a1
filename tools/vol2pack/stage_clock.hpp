#pragma once
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/reporter.hpp"

namespace tomodem::vol2pack {

/// Wall time of the stages of a run, one after the other; they go to --json as `seconds`.
class StageClock {
 public:
    /// What happened since the last call, or since the clock was made.
    void done(const std::string& stage) {
        const auto now = std::chrono::steady_clock::now();
        seconds_[stage] = std::round(1e3 * std::chrono::duration<double>(now - last_).count()) / 1e3;
        last_ = now;
    }
    void report(Reporter& reporter) const { reporter.report_json("seconds", seconds_); }

 private:
    nlohmann::ordered_json seconds_ = nlohmann::ordered_json::object();
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace tomodem::vol2pack
