#pragma once
#include <cstdint>

namespace tomodem::plugin {

/// The step that a pair loop computes.
struct PairStep {
    std::int64_t number = 0;
    double time_step = 0;
    bool renumbered = true;      ///< the solver has exchanged or sorted particles
    bool set_up = true;          ///< first computation: every pair in the crown was there before
    double start = 0;            ///< of what is computed, in time after the step [s]: not 0 within a step made in parts
    double* velocity = nullptr;  ///< 3 per particle, ghosts included: for a kernel that finds them
};

}  // namespace tomodem::plugin
