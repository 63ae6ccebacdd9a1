#include "tools/plan/trade_table.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/error.hpp"
#include "tools/plan/shipped_trade.hpp"

namespace tomodem {
namespace {

constexpr std::int64_t format = 1;
constexpr std::array laws{Law::bilin, Law::trilin, Law::norton};

/// Straight in the logarithm of x, constant beyond the ends.
double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto right = std::lower_bound(x.begin(), x.end(), at) - x.begin();
    if (right == 0) return y.front();
    if (right == static_cast<std::ptrdiff_t>(x.size())) return y.back();
    return std::lerp(y[right - 1], y[right], std::log(at / x[right - 1]) / std::log(x[right] / x[right - 1]));
}

/// One table of the file; every key of it must be asked for.
class Reader {
 public:
    Reader(const toml::table& table, std::string where, const std::string& file)
        : table_(table), where_(std::move(where)), file_(file) {}

    [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
        throw InvalidInput(fmt::format("table '{}' line {}: {}", file_, std::max(1u, node.source().begin.line), what));
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
    double number(const toml::node& node, const std::string& key) const {
        const auto value = node.is_number() ? node.value<double>() : std::nullopt;
        if (!value || !std::isfinite(*value)) fail(node, fmt::format("{} in [{}] must be a number", key, where_));
        return *value;
    }
    double not_negative(const std::string& key) {
        const double value = number(get(key), key);
        if (value < 0) fail(get(key), fmt::format("{} in [{}] must not be below 0", key, where_));
        return value;
    }
    double positive(const std::string& key) {
        const double value = number(get(key), key);
        if (value <= 0) fail(get(key), fmt::format("{} in [{}] must be above 0", key, where_));
        return value;
    }
    std::string text(const std::string& key) {
        const auto value = get(key).value_exact<std::string>();
        if (!value) fail(get(key), fmt::format("{} in [{}] must be a string", key, where_));
        return *value;
    }
    /// Numbers of at least 0.
    std::vector<double> list(const std::string& key, std::size_t length = 0) {
        const toml::node& node = get(key);
        std::vector<double> values;
        if (const toml::array* array = node.as_array())
            for (const toml::node& one : *array) values.push_back(number(one, key));
        if (values.empty() || (length > 0 && values.size() != length))
            fail(node, fmt::format("{} in [{}] must be a list of {} numbers", key, where_,
                                   length > 0 ? std::to_string(length) : "one or more"));
        if (*std::min_element(values.begin(), values.end()) < 0)
            fail(node, fmt::format("{} in [{}] must not be below 0", key, where_));
        return values;
    }
    std::vector<double> rising(const std::string& key) {
        const std::vector<double> values = list(key);
        if (values.front() <= 0 ||
            std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
            fail(get(key), fmt::format("{} in [{}] must rise, from above 0", key, where_));
        return values;
    }
    std::array<double, 2> pair(const std::string& key) {
        const std::vector<double> values = list(key, 2);
        return {values[0], values[1]};
    }
    std::optional<Reader> table(const std::string& key) {
        const toml::node* node = find(key);
        if (node == nullptr) return {};
        if (!node->is_table()) fail(*node, fmt::format("{} in [{}] must be a table", key, where_));
        return Reader(*node->as_table(), where_.empty() ? key : where_ + "." + key, file_);
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

TradeCurve read_curve(Reader& reader) {
    TradeCurve curve;
    curve.resolution = reader.rising("resolution");
    curve.bias = reader.list("bias", curve.resolution.size());
    curve.spread = reader.list("spread", curve.resolution.size());
    curve.step = reader.rising("step");
    curve.step_error = reader.list("step_error", curve.step.size());
    if (reader.find("rate_error") != nullptr) curve.rate_error = reader.not_negative("rate_error");
    curve.particle_step = reader.positive("particle_step");
    curve.bytes = reader.pair("bytes");
    curve.prepare = reader.pair("prepare");
    reader.refuse_unknown();
    return curve;
}

LawTrade read_law(Reader& reader) {
    LawTrade law;
    law.density = reader.positive("density");
    for (const Quantity quantity : quantities)
        if (auto curve = reader.table(name_of(quantity))) law.curve[quantity] = read_curve(*curve);
    reader.refuse_unknown();
    return law;
}

}  // namespace

const char* name_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::flow_stress:
            return "flow_stress";
        case Quantity::composite_stress:
            return "composite_stress";
        case Quantity::shape_factor:
            return "shape_factor";
        case Quantity::pore_volume:
            return "pore_volume";
        case Quantity::foam_stress:
            break;
    }
    return "foam_stress";
}

const char* name_of(Law law) {
    return law == Law::bilin ? "bilin" : law == Law::trilin ? "trilin" : "norton";
}

bool is_stress(Quantity quantity) {
    return quantity != Quantity::shape_factor && quantity != Quantity::pore_volume;
}

double ErrorParts::total() const {
    return std::hypot(std::hypot(resolution, time_step), std::hypot(packings, rates));
}

const char* ErrorParts::largest() const {
    const std::array<std::pair<double, const char*>, 4> parts{{{resolution, "resolution"},
                                                               {time_step, "the time step"},
                                                               {packings, "what one packing differs from another"},
                                                               {rates, "the law, as the rate changes"}}};
    return std::max_element(parts.begin(), parts.end())->second;
}

ErrorParts TradeCurve::error(double at_resolution, double at_step) const {
    constexpr double rounding = 1e-9;
    if (at_resolution < resolution.front() * (1 - rounding) || at_step > step.back() * (1 + rounding))
        throw std::out_of_range("coarser than the table");
    return {interpolated(resolution, bias, at_resolution), interpolated(step, step_error, at_step),
            2 * interpolated(resolution, spread, at_resolution), 0};
}

TradeTable parse_trade(const std::string& text, const std::string& file) {
    toml::table root;
    try {
        root = toml::parse(text, file);
    } catch (const toml::parse_error& error) {
        throw InvalidInput(fmt::format("table '{}' line {}: {}", file, error.source().begin.line, error.description()));
    }
    Reader all(root, "", file);
    auto trade = all.table("trade");
    if (!trade) throw InvalidInput(fmt::format("table '{}' has no [trade]; pipelines/trade makes one", file));
    all.refuse_unknown();
    if (trade->get("format").value_exact<std::int64_t>() != format)
        trade->fail(trade->get("format"), fmt::format("format in [trade] must be {}", format));
    TradeTable table;
    table.name = trade->text("name");
    table.processor = trade->text("processor");
    for (const Law law : laws)
        if (auto reader = trade->table(name_of(law))) table.law[law] = read_law(*reader);
    trade->refuse_unknown();
    return table;
}

const TradeTable& shipped_trade() {
    static const TradeTable table = parse_trade(shipped_trade_text, "trade.toml");
    return table;
}

}  // namespace tomodem
