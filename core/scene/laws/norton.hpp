#pragma once
#include "core/law/norton_law.hpp"
#include "core/scene/calibration.hpp"
#include "core/scene/model.hpp"

namespace tomodem {

struct NortonCalibration : CalibrationWindow {
    static constexpr const char* law = "norton";

    double flow = 0;                          ///< a law that is given K has the stress flow K rate^M
    std::array<double, 2> sensitivity{0, 0};  ///< M, smallest and largest seen
    double rate_ratio = 1;                    ///< between the highest and the lowest rate seen with the same constants
    DirectedErrors error;
};

/// What a model of NORTON has beside the phases' pairs, which say stiffness and period of its cores.
struct NortonModel : LawConstants {
    law::Norton norton;
};

/// @param model  of law "norton"
const law::Norton& norton_of(const Model& model);

}  // namespace tomodem
