#include "core/scene/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/toml_reader.hpp"
#include "core/scene/shipped_calibration.hpp"

namespace tomodem {
namespace {

constexpr std::int64_t format = 1;

void read_window(TomlReader& reader, CalibrationWindow& window, bool has_crown) {
    window.packings = static_cast<int>(reader.number("packings", 1));
    window.density = reader.positive("density");
    window.particles = reader.rising("particles");
    window.size = reader.list("size", window.particles.size(), -1);
    window.strain = reader.range("strain");
    if (reader.find("strain_tension") != nullptr) window.strain_tension = reader.range("strain_tension");
    window.strain_error = reader.number("strain_error");
    if (!has_crown) return;
    window.crown = reader.number("crown", 1);
    window.stiffness_ratio = reader.positive("stiffness_ratio");
}

BilinCalibration read_bilin(TomlReader reader) {
    BilinCalibration found;
    found.curve.chi = reader.rising("chi");
    if (found.curve.chi.size() < 2) reader.fail(reader.get("chi"), "chi of the master curve needs two values or more");
    found.curve.flow = reader.list("flow", found.curve.chi.size());
    if (*std::min_element(found.curve.flow.begin(), found.curve.flow.end()) <= 0)
        reader.fail(reader.get("flow"), "flow of the master curve must be above 0");
    found.spread = reader.list("spread", found.curve.chi.size());
    found.curve.greatest_sensitivity = reader.number("greatest_sensitivity");
    found.strain_per_step = reader.range("strain_per_step");
    found.time_step_error = reader.list("time_step_error", found.curve.chi.size());
    read_window(reader, found, true);
    reader.refuse_unknown();
    return found;
}

DirectedErrors read_errors(TomlReader& reader) {
    return {reader.optional("compression"), reader.optional("tension")};
}

TrilinCalibration read_trilin(TomlReader reader) {
    TrilinCalibration found;
    found.flow = {reader.positive("flow"), reader.number("sensitivity", -1), reader.number("tolerance")};
    found.rate = reader.range("rate");
    found.error = read_errors(reader);
    read_window(reader, found, true);
    reader.refuse_unknown();
    return found;
}

NortonCalibration read_norton(TomlReader reader) {
    NortonCalibration found;
    found.flow = reader.positive("flow");
    found.sensitivity = reader.range("sensitivity");
    found.rate_ratio = reader.number("rate_ratio", 1);
    found.error = read_errors(reader);
    read_window(reader, found, false);
    reader.refuse_unknown();
    return found;
}

}  // namespace

double CalibrationWindow::size_error(double count) const {
    return interpolated_in_logarithm(particles, size, count);
}

double BilinCalibration::spread_at(double chi) const {
    return interpolated_in_logarithm(curve.chi, spread, chi);
}

double BilinCalibration::time_step_error_at(double chi) const {
    return interpolated_in_logarithm(curve.chi, time_step_error, chi);
}

Calibration parse_calibration(const std::string& text, const std::string& file) {
    toml::table root;
    try {
        root = toml::parse(text);
    } catch (const toml::parse_error& error) {
        throw InvalidInput(
            fmt::format("calibration '{}' line {}: {}", file, error.source().begin.line, error.description()));
    }
    const toml::table* const table = root["calibration"].as_table();
    if (table == nullptr)
        throw InvalidInput(
            fmt::format("calibration '{}' has no table [calibration]; pipelines/calibrate makes one", file));
    TomlReader reader(*table, "calibration", fmt::format("calibration '{}'", file));
    if (reader.number("format") != format)
        reader.fail(reader.get("format"), fmt::format("format is another than {}, which this version reads", format));
    Calibration found;
    if (const auto name = reader.get("name").value_exact<std::string>()) found.name = *name;
    if (auto bilin = reader.table("bilin")) found.bilin = read_bilin(*bilin);
    if (auto trilin = reader.table("trilin")) found.trilin = read_trilin(*trilin);
    if (auto norton = reader.table("norton")) found.norton = read_norton(*norton);
    reader.refuse_unknown();
    return found;
}

const Calibration& shipped_calibration() {
    static const Calibration shipped = parse_calibration(shipped_calibration_text, "that tomodem ships");
    return shipped;
}

}  // namespace tomodem
