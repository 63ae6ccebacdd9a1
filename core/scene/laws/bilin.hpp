#pragma once
#include "core/law/bilin_flow.hpp"
#include "core/scene/calibration.hpp"

namespace tomodem {

struct BilinCalibration : CalibrationWindow {
    static constexpr const char* law = "bilin";

    law::BilinFlow curve;
    std::vector<double> spread;                   ///< of each flow: relative standard deviation over the packings
    std::array<double, 2> strain_per_step{0, 0};  ///< strain in a time step, smallest and largest seen
    std::vector<double> time_step_error;          ///< of each flow, between them: share

    double spread_at(double chi) const;
    double time_step_error_at(double chi) const;
};

}  // namespace tomodem
