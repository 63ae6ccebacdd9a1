#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/calibrate/calibration_fit.hpp"

namespace tomodem::calibrate {
namespace {

std::string list(const auto& values) {
    std::vector<std::string> words;
    for (const double value : values) words.push_back(fmt::format("{:.6g}", value));
    return fmt::format("[{}]", fmt::join(words, ", "));
}

std::string window_text(const CalibrationWindow& window) {
    std::string text = fmt::format("packings = {}\ndensity = {:.4g}\n", window.packings, window.density);
    if (window.crown) text += fmt::format("crown = {:.6g}\n", *window.crown);
    if (window.stiffness_ratio) text += fmt::format("stiffness_ratio = {:.6g}\n", *window.stiffness_ratio);
    const std::string tension =
        window.strain_tension ? fmt::format("strain_tension = {}\n", list(*window.strain_tension)) : "";
    return text + fmt::format("particles = {}\nsize = {}\nstrain = {}\n{}strain_error = {:g}\n", list(window.particles),
                              list(window.size), list(window.strain), tension, window.strain_error);
}

std::string errors_text(const DirectedErrors& error) {
    std::string text;
    if (error.compression) text += fmt::format("compression = {:.4g}\n", *error.compression);
    if (error.tension) text += fmt::format("tension = {:.4g}\n", *error.tension);
    return text;
}

}  // namespace

std::string calibration_text(const Calibration& table) {
    std::string text =
        "# Made by calibration_table; docs/calibration.md says what each key means.\n[calibration]\nformat = 1\n";
    text += fmt::format("name = \"{}\"\n", table.name);
    if (const auto* const found = table.find<BilinCalibration>()) {
        const BilinCalibration& bilin = *found;
        text += fmt::format(
            "\n# flow stress = k_rep / (2 r_s) flow(chi), chi = rate t0^2 / time_step\n[calibration.bilin]\n"
            "chi = {}\nflow = {}\nspread = {}\ngreatest_sensitivity = {:.4g}\nstrain_per_step = {}\n"
            "time_step_error = {}\n",
            list(bilin.curve.chi), list(bilin.curve.flow), list(bilin.spread), bilin.curve.max_sensitivity,
            list(bilin.strain_per_step), list(bilin.time_step_error));
        text += window_text(bilin);
    }
    if (const auto* const found = table.find<TrilinCalibration>()) {
        const TrilinCalibration& trilin = *found;
        text += fmt::format(
            "\n# flow stress = k_rep / (2 r_s) flow (rate t0)^sensitivity\n[calibration.trilin]\n"
            "flow = {:.6g}\nsensitivity = {:.4g}\ntolerance = {:.4g}\nrate = {}\n",
            trilin.flow.flow, trilin.flow.sensitivity, trilin.flow.tolerance, list(trilin.rate));
        text += errors_text(trilin.error) + window_text(trilin);
    }
    if (const auto* const found = table.find<NortonCalibration>()) {
        const NortonCalibration& norton = *found;
        text += fmt::format(
            "\n# flow stress = K rate^M for a law that is given K / flow\n[calibration.norton]\n"
            "flow = {:.6g}\nsensitivity = {}\nrate_ratio = {:.6g}\n",
            norton.flow, list(norton.sensitivity), norton.rate_ratio);
        text += errors_text(norton.error) + window_text(norton);
    }
    return text;
}

}  // namespace tomodem::calibrate
