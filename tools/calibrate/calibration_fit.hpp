#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/laws/bilin.hpp"
#include "core/scene/laws/norton.hpp"
#include "core/scene/laws/trilin.hpp"
#include "core/scene/scene.hpp"

/// From runs of one material to the table that turns norton = { K, M } into constants (docs/calibration.md).
namespace tomodem::calibrate {

/// Where the flow stress of a run is taken: the mean over |strain| within `window` of `at`.
struct FlowStrain {
    double at = 0.3, window = 0.05;
};

/// What a run of one phase says of its law.
struct MeasuredRun {
    std::string file;
    std::string law = "bilin";
    bool tension = false;
    double particles = 0, density = 0, crown = 0, stiffness_ratio = 0;
    double control = 0;          ///< BILIN: chi; TRILIN: rate t0; NORTON: M
    double rate = 0;             ///< [1/s]
    double strain_per_step = 0;  ///< [-]
    /// BILIN, TRILIN: stress over k_rep / (2 r_s); NORTON: stress over K rate^M for a law that is given K.
    double flow = 0;
    std::vector<double> ratio;  ///< stress over flow stress at |strain| = 0, 0.01, 0.02, ...; NaN where it did not get
};

/// Spacing of MeasuredRun::ratio.
inline constexpr double ratio_spacing = 0.01;

/// @throws InvalidInput naming the file: no scene in it, several phases, a changing rate, hardening, or a strain that
///         does not get to where the flow stress is taken
MeasuredRun measure_run(const std::filesystem::path& run, const FlowStrain& where);

/// What belongs to the table itself; runs of other sizes and time steps say what those change.
struct FitOptions {
    double particles = 0;        ///< 0: those of the most runs of a law
    double strain_per_step = 0;  ///< of BILIN; 0: that of the most runs
    double strain_error = 0.1;   ///< the window of strain ends where the mean stress of a row leaves it by this share
    FlowStrain where;
    std::string name;
};

/// The table of the laws that there are runs of.
///
/// BILIN: a row for each chi, mean and spread over the packings. TRILIN: least squares of log(flow) against log(rate
/// t0), of the means of both directions. NORTON: the mean of all. Their errors are the largest deviation of a mean from
/// that, and twice the spread beside it.
/// @throws InvalidInput without a run, or with too few to make a table of
Calibration fit_calibration(const std::vector<MeasuredRun>& runs, const FitOptions& options);

/// The table as TOML text, which parse_calibration reads.
std::string calibration_text(const Calibration& calibration);

}  // namespace tomodem::calibrate
