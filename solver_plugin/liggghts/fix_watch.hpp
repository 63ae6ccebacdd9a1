#pragma once
#include <functional>

#include "solver_plugin/liggghts/liggghts.hpp"

namespace tomodem::plugin {

/// `fix ID all tomodem/watch`: calls a function between the steps of a run, which may throw to end it. Nothing else
/// changes, in contrast to a run that is cut into several.
class FixWatch : public LAMMPS_NS::Fix {
 public:
    /// Returns after how many steps it wants to be called again.
    using Watch = std::function<std::int64_t()>;

    FixWatch(LAMMPS_NS::LAMMPS* lmp, int count, char** words) : Fix(lmp, count, words) { nevery = 1; }

    /// From now on; an empty one is not called.
    void call(const Watch& watch) {
        watch_ = watch;
        left_ = 0;
    }

    int setmask() override { return LAMMPS_NS::FixConst::END_OF_STEP; }
    void end_of_step() override {
        if (watch_ && --left_ < 0) left_ = watch_() - 1;
    }

 private:
    Watch watch_;
    std::int64_t left_ = 0;
};

}  // namespace tomodem::plugin
