#include "core/scene/calibration.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/base/toml_reader.hpp"
#include "core/scene/law.hpp"
#include "core/scene/shipped_calibration.hpp"

namespace tomodem {
namespace {

constexpr std::int64_t format = 1;

}  // namespace

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

DirectedErrors read_errors(TomlReader& reader) {
    return {reader.optional("compression"), reader.optional("tension")};
}

double CalibrationWindow::size_error(double count) const {
    return interpolated_in_logarithm(particles, size, count);
}

Calibration parse_calibration(const std::string& text, const std::string& file) {
    const std::string what = fmt::format("calibration '{}'", file);
    const toml::table root = parse_toml(text, what);
    const toml::table* const table = root["calibration"].as_table();
    if (table == nullptr)
        throw InvalidInput(fmt::format("{} has no table [calibration]; pipelines/calibrate makes one", what));
    TomlReader reader(*table, "[calibration]", what);
    if (reader.number("format") != format)
        reader.fail(reader.get("format"), fmt::format("format is another than {}, which this version reads", format));
    Calibration found;
    if (const auto name = reader.get("name").value_exact<std::string>()) found.name = *name;
    for (const Law* law : laws())
        if (auto of_law = reader.table(law->name()))
            if (auto read = law->read_calibration(*of_law)) {
                of_law->refuse_unknown();
                found.tables[law->name()] = std::move(read);
            }
    reader.refuse_unknown();
    return found;
}

const Calibration& shipped_calibration() {
    static const Calibration shipped = parse_calibration(shipped_calibration_text, "that tomodem ships");
    return shipped;
}

}  // namespace tomodem
