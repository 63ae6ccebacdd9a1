#include "tools/plan/trade_table.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

#include "core/base/error.hpp"

namespace tomodem::plan {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string text = R"([trade]
format = 1
name = "of a test"
processor = "none"
[trade.bilin]
density = 0.7
[trade.bilin.shape_factor]
resolution = [4, 16]
bias = [0.2, 0.1]
spread = [0.02, 0.01]
step = [1e-5, 1e-4]
step_error = [0, 0.04]
particle_step = 4e-8
bytes = [4e7, 600]
prepare = [1e-4, 0.5]
)";

std::string replaced(std::string in, const std::string& what, const std::string& by) {
    return in.replace(in.find(what), what.size(), by);
}

TEST(TradeTable, IsStraightBetweenItsPointsInTheLogarithms) {
    const TradeTable table = parse_trade(text, "table.toml");
    const ErrorParts parts = table.law.at("bilin").curve.at(Quantity::shape_factor).error(8, std::sqrt(1e-9));
    EXPECT_NEAR(parts.resolution, 0.15, 1e-12);
    EXPECT_NEAR(parts.packings, 2 * 0.015, 1e-12);
    EXPECT_NEAR(parts.time_step, 0.02, 1e-12);
    EXPECT_NEAR(parts.total(), std::sqrt(0.15 * 0.15 + 0.03 * 0.03 + 0.02 * 0.02), 1e-12);
    EXPECT_STREQ(parts.largest(), "resolution");
}

TEST(TradeTable, PromisesNothingMoreBeyondItsFinestPoint) {
    const TradeCurve curve = parse_trade(text, "table.toml").law.at("bilin").curve.at(Quantity::shape_factor);
    EXPECT_EQ(curve.error(100, 1e-7).total(), curve.error(16, 1e-5).total());
}

TEST(TradeTable, KnowsNothingBeyondItsCoarsestPoint) {
    const TradeCurve curve = parse_trade(text, "table.toml").law.at("bilin").curve.at(Quantity::shape_factor);
    EXPECT_THROW(curve.error(3.9, 1e-5), std::out_of_range);
    EXPECT_THROW(curve.error(4, 2e-4), std::out_of_range);
}

TEST(TradeTable, ThatShipsHasEveryQuantityOfItsLaws) {
    const TradeTable& table = shipped_trade();
    for (const std::string law : {"bilin", "trilin", "norton"})
        for (const Quantity quantity : quantities) {
            // TRILIN has no M of the phase A that objects are measured in.
            const bool known =
                law != "trilin" || (quantity != Quantity::composite_stress && quantity != Quantity::shape_factor);
            EXPECT_EQ(table.law.at(law).curve.contains(quantity), known) << law << ' ' << name_of(quantity);
        }
}

TEST(TradeTable, ThatShipsWasMeasuredWithThePackingsOfItsLaws) {
    for (const auto& [law, trade] : shipped_trade().law)
        EXPECT_EQ(trade.density, find_law(law)->traits().packing_density) << law;
}

TEST(TradeTable, RejectsWhatIsWrongWithItsLine) {
    const auto rejected = [](const std::string& what, const std::string& by, const std::string& message) {
        EXPECT_THAT([&] { parse_trade(replaced(text, what, by), "table.toml"); },
                    ThrowsMessage<InvalidInput>(HasSubstr(message)));
    };
    rejected("[4, 16]", "[16, 4]", "table 'table.toml' line 8: resolution in [trade.bilin.shape_factor] must rise");
    rejected("[0.2, 0.1]", "[0.2]", "line 9: bias in [trade.bilin.shape_factor] must be a list of 2 numbers");
    rejected("[0.02, 0.01]", "[0.02, -0.01]",
             "line 10: spread in [trade.bilin.shape_factor] must be a number of at least 0");
    rejected("density", "densty", "[trade.bilin] has no 'density'");
    rejected("particle_step = 4e-8", "particle_step = 0",
             "particle_step in [trade.bilin.shape_factor] must be above 0");
    rejected("shape_factor", "shape", "unknown key 'shape' in [trade.bilin]");
    rejected("format = 1", "format = 2", "format in [trade] must be 1");
    rejected("0.7", "0.7.1", "table 'table.toml' line 6");
    EXPECT_THAT([] { parse_trade("", "table.toml"); }, ThrowsMessage<InvalidInput>(HasSubstr("has no [trade]")));
}

}  // namespace
}  // namespace tomodem::plan
