#include "core/calibration.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "core/shipped_calibration.hpp"

namespace tomodem {
namespace {

constexpr std::int64_t format = 1;

/// Straight in the logarithm of x, constant beyond the ends.
double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto right = std::lower_bound(x.begin(), x.end(), at) - x.begin();
    if (right == 0) return y.front();
    if (right == static_cast<std::ptrdiff_t>(x.size())) return y.back();
    const double share = std::log(at / x[right - 1]) / std::log(x[right] / x[right - 1]);
    return std::lerp(y[right - 1], y[right], share);
}

/// One table of the file; every key of it must be asked for.
class Reader {
 public:
    Reader(const toml::table& table, std::string where, const std::string& file)
        : table_(table), where_(std::move(where)), file_(file) {}

    [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
        throw InvalidInput(
            fmt::format("calibration '{}' line {}: {}", file_, std::max(1u, node.source().begin.line), what));
    }

    const toml::node* find(const std::string& key) {
        known_.insert(key);
        return table_.get(key);
    }
    const toml::node& get(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) fail(table_, fmt::format("[{}] has no '{}'", where_, key));
        return *node;
    }

    double number(const toml::node& node, const std::string& key, double least) const {
        const auto value = node.is_number() ? node.value<double>() : std::nullopt;
        if (!value || !(*value >= least) || !std::isfinite(*value))
            fail(node, fmt::format("{} in [{}] must be a number of at least {:g}", key, where_, least));
        return *value;
    }
    double number(const std::string& key, double least = 0) { return number(get(key), key, least); }
    std::optional<double> optional(const std::string& key, double least = 0) {
        const toml::node* node = find(key);
        return node == nullptr ? std::nullopt : std::optional(number(*node, key, least));
    }
    double positive(const std::string& key) {
        const double value = number(key);
        if (value == 0) fail(get(key), fmt::format("{} in [{}] must be above 0", key, where_));
        return value;
    }
    std::vector<double> list(const std::string& key, std::size_t length = 0, double least = 0) {
        const toml::node& node = get(key);
        std::vector<double> values;
        if (const toml::array* array = node.as_array())
            for (const toml::node& one : *array) values.push_back(number(one, key, least));
        if (values.empty() || (length > 0 && values.size() != length))
            fail(node, fmt::format("{} in [{}] must be a list of {} numbers", key, where_,
                                   length > 0 ? std::to_string(length) : "one or more"));
        return values;
    }
    std::vector<double> rising(const std::string& key) {
        const std::vector<double> values = list(key);
        if (values.front() <= 0 ||
            std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
            fail(get(key), fmt::format("{} in [{}] must rise, from above 0", key, where_));
        return values;
    }
    std::array<double, 2> range(const std::string& key) {
        const std::vector<double> values = list(key, 2);
        if (values[0] > values[1]) fail(get(key), fmt::format("{} in [{}] must be [least, greatest]", key, where_));
        return {values[0], values[1]};
    }
    std::optional<Reader> table(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        if (!node->is_table()) fail(*node, fmt::format("{} must be a table, [{}.{}]", key, where_, key));
        return Reader(*node->as_table(), where_ + "." + key, file_);
    }
    void refuse_unknown() const {
        for (const auto& [key, node] : table_)
            if (!known_.contains(std::string(key.str())))
                fail(node,
                     fmt::format("unknown key '{}' in [{}]; known are {}", key.str(), where_, fmt::join(known_, ", ")));
    }

 private:
    const toml::table& table_;
    std::string where_;
    const std::string& file_;
    std::set<std::string> known_;
};

void read_window(Reader& reader, CalibrationWindow& window, bool has_crown) {
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

BilinCalibration read_bilin(Reader reader) {
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

DirectedErrors read_errors(Reader& reader) {
    return {reader.optional("compression"), reader.optional("tension")};
}

TrilinCalibration read_trilin(Reader reader) {
    TrilinCalibration found;
    found.flow = {reader.positive("flow"), reader.number("sensitivity", -1), reader.number("tolerance")};
    found.rate = reader.range("rate");
    found.error = read_errors(reader);
    read_window(reader, found, true);
    reader.refuse_unknown();
    return found;
}

NortonCalibration read_norton(Reader reader) {
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
    return interpolated(particles, size, count);
}

double BilinCalibration::spread_at(double chi) const {
    return interpolated(curve.chi, spread, chi);
}

double BilinCalibration::time_step_error_at(double chi) const {
    return interpolated(curve.chi, time_step_error, chi);
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
    Reader reader(*table, "calibration", file);
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
