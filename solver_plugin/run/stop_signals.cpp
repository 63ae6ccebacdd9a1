#include "solver_plugin/run/stop_signals.hpp"

#include <signal.h>

#include <atomic>
#include <iterator>

namespace tomodem {
namespace {

constexpr int numbers[] = {SIGTERM, SIGINT, SIGUSR1};
std::atomic<int> last_seen{0};
struct sigaction before[std::size(numbers)];

extern "C" void remember_signal(int number) {
    last_seen = number;
}

}  // namespace

StopSignals::StopSignals() {
    last_seen = 0;
    for (std::size_t k = 0; k < std::size(numbers); ++k) {
        ::sigaction(numbers[k], nullptr, &before[k]);
        if (before[k].sa_handler == SIG_IGN) continue;
        struct sigaction action {};
        action.sa_handler = remember_signal;
        action.sa_flags = SA_RESTART;
        ::sigaction(numbers[k], &action, nullptr);
    }
}

StopSignals::~StopSignals() {
    for (std::size_t k = 0; k < std::size(numbers); ++k) ::sigaction(numbers[k], &before[k], nullptr);
}

int StopSignals::seen() {
    return last_seen;
}

const char* StopSignals::name(int number) {
    return number == SIGTERM ? "SIGTERM" : number == SIGINT ? "SIGINT" : number == SIGUSR1 ? "SIGUSR1" : "a signal";
}

}  // namespace tomodem
