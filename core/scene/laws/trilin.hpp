#pragma once
#include "core/law/trilin_flow.hpp"
#include "core/scene/calibration.hpp"

namespace tomodem {

struct TrilinCalibration : CalibrationWindow {
    static constexpr const char* law = "trilin";

    law::TrilinFlow flow;
    std::array<double, 2> rate{0, 0};  ///< rate t0, smallest and largest seen
    DirectedErrors error;
};

}  // namespace tomodem
