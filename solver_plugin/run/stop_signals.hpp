#pragma once

namespace tomodem {

/// While one is alive, SIGTERM, SIGINT and SIGUSR1 do not end the process but are remembered, so that a run can be
/// stopped in order. "Ignore" (nohup) stays.
class StopSignals {
 public:
    StopSignals();
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    /// The last of them that came since the start, 0 for none.
    static int seen();
    static const char* name(int number);
};

}  // namespace tomodem
