#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/law/bilin_flow.hpp"
#include "core/law/trilin_flow.hpp"

/// Measured flow stresses: what turns norton = { K, M } into the constants of a law, and how far it may be trusted
/// (docs/calibration.md has the file).
namespace tomodem {

/// What the flow stresses of a law were measured on, and what they are worth. Errors are shares of the stress.
struct CalibrationWindow {
    int packings = 0;
    double density = 0;                  ///< D of the packings
    std::vector<double> particles;       ///< sizes seen, increasing
    std::vector<double> size;            ///< stress of each size over the table's, less 1: the largest seen
    std::array<double, 2> strain{0, 0};  ///< |true strain| within which the stress keeps to the table's ...
    std::optional<std::array<double, 2>> strain_tension;  ///< the same in tension; none: not measured
    double strain_error = 0;                              ///< ... within this
    std::optional<double> crown;                          ///< r_c / r_s (not NORTON's: it has one only)
    std::optional<double> stiffness_ratio;                ///< k_rep / k_att (the same)

    /// `size` for a sample of so many particles: straight in their logarithm, constant beyond the sizes seen.
    double size_error(double count) const;
};

struct BilinCalibration : CalibrationWindow {
    law::BilinFlow curve;
    std::vector<double> spread;                   ///< of each flow: relative standard deviation over the packings
    std::array<double, 2> strain_per_step{0, 0};  ///< strain in a time step, smallest and largest seen
    std::vector<double> time_step_error;          ///< of each flow, between them: share

    double spread_at(double chi) const;
    double time_step_error_at(double chi) const;
};

/// Errors of TRILIN and NORTON: the greatest deviation from the law fitted, and twice the spread over packings.
struct DirectedErrors {
    std::optional<double> compression, tension;  ///< none: not measured
};

struct TrilinCalibration : CalibrationWindow {
    law::TrilinFlow flow;
    std::array<double, 2> rate{0, 0};  ///< rate t0, smallest and largest seen
    DirectedErrors error;
};

struct NortonCalibration : CalibrationWindow {
    double flow = 0;                          ///< a law that is given K has the stress flow K rate^M
    std::array<double, 2> sensitivity{0, 0};  ///< M, smallest and largest seen
    double rate_ratio = 1;                    ///< between the highest and the lowest rate seen with the same constants
    DirectedErrors error;
};

struct Calibration {
    std::string name;
    std::optional<BilinCalibration> bilin;
    std::optional<TrilinCalibration> trilin;
    std::optional<NortonCalibration> norton;
};

/// Reads the table [calibration] of a TOML text, a scene's or one of its own; `file` stands for it in errors.
/// @throws InvalidInput with the line: syntax, unknown or missing key, lists that do not fit together, wrong range
Calibration parse_calibration(const std::string& text, const std::string& file);

/// The one that tomodem ships (core/law/calibration.toml).
const Calibration& shipped_calibration();

}  // namespace tomodem
