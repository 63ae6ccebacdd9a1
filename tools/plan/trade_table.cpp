#include "tools/plan/trade_table.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/base/error.hpp"
#include "core/base/toml_reader.hpp"
#include "tools/plan/shipped_trade.hpp"
#include "tools/plan/toml_text.hpp"

namespace tomodem::plan {
namespace {

constexpr std::int64_t format = 1;

TradeCurve read_curve(TomlReader& reader) {
    TradeCurve curve;
    curve.resolution = reader.rising("resolution");
    curve.bias = reader.list("bias", curve.resolution.size());
    curve.spread = reader.list("spread", curve.resolution.size());
    curve.step = reader.rising("step");
    curve.step_error = reader.list("step_error", curve.step.size());
    curve.rate_error = reader.optional("rate_error");
    curve.particle_step = reader.positive("particle_step");
    curve.bytes = reader.pair("bytes");
    curve.prepare = reader.pair("prepare");
    reader.refuse_unknown();
    return curve;
}

LawTrade read_law(TomlReader& reader) {
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
    return {interpolated_in_logarithm(resolution, bias, at_resolution),
            interpolated_in_logarithm(step, step_error, at_step),
            2 * interpolated_in_logarithm(resolution, spread, at_resolution), 0};
}

TradeTable parse_trade(const std::string& text, const std::string& file) {
    const toml::table root = parse_toml(text, fmt::format("table '{}'", file));
    TomlReader all(root, "", fmt::format("table '{}'", file));
    auto trade = all.table("trade");
    if (!trade) throw InvalidInput(fmt::format("table '{}' has no [trade]; pipelines/trade makes one", file));
    all.refuse_unknown();
    if (trade->get("format").value_exact<std::int64_t>() != format)
        trade->fail(trade->get("format"), fmt::format("format in [trade] must be {}", format));
    TradeTable table;
    table.name = trade->text("name");
    table.processor = trade->text("processor");
    for (const Law* law : laws())
        if (auto reader = trade->table(law->name())) table.law[law->name()] = read_law(*reader);
    trade->refuse_unknown();
    return table;
}

const TradeTable& shipped_trade() {
    static const TradeTable table = parse_trade(shipped_trade_text, "trade.toml");
    return table;
}

}  // namespace tomodem::plan
