#include "tools/plan/trade_fit.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "core/base/error.hpp"

namespace tomodem::plan {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;
using testing::ThrowsMessage;

/// Of a sweep in which everything is known: the value is `right` (1 + error), a step costs 4e-8 s and a particle 600
/// bytes on top of 4e7.
SweepRow row(const std::string& quantity, double size, double step, const std::string& packing, double error,
             const std::string& law = "bilin") {
    SweepRow made;
    made.scene = "inclusion";
    made.law = law;
    made.size = size;
    made.step = step;
    made.rate = 1;
    made.filter = "level-set";
    made.packing = packing;
    made.quantity = quantity;
    made.value = 2 * (1 + error);
    made.particles = 10 * size * size * size;
    made.steps = 0.3 / step;
    made.time_step = step / 1e-3;
    made.cpu_solve = 4e-8 * made.particles * made.steps;
    made.cpu_prepare = 0.5 + 1e-5 * made.particles * std::cbrt(made.particles / 1000);
    made.peak_bytes = 4e7 + 600 * made.particles;
    return made;
}

const References references{{"shape_factor", {{1, 2}, {0.1, 2}}}};

/// Sizes 4, 8, 16 at the base step, of two packings; two other steps at size 8.
std::vector<SweepRow> sweep() {
    std::vector<SweepRow> rows;
    const std::vector<std::array<double, 2>> errors{{0.3, 0.1}, {0.02, -0.02}, {0.06, 0.04}};
    for (int k = 0; k < 3; ++k)
        for (int packing = 0; packing < 2; ++packing)
            rows.push_back(row("shape_factor", 4 << k, 2e-5, std::to_string(packing), errors[k][packing]));
    for (const auto& [step, change] : {std::pair(1e-5, 0.01), {1e-4, -0.03}, {4e-4, 0.02}})
        for (int packing = 0; packing < 2; ++packing)
            rows.push_back(
                row("shape_factor", 8, step, std::to_string(packing), (1 + errors[1][packing]) * (1 + change) - 1));
    return rows;
}

TradeCurve fitted(const std::vector<SweepRow>& rows) {
    return fit_trade(rows, references, {{"bilin", 0.7}}).law.at("bilin").curve.at(Quantity::shape_factor);
}

TEST(TradeFit, NoSizeIsSaidToBeBetterThanAFinerOne) {
    const TradeCurve curve = fitted(sweep());
    EXPECT_THAT(curve.resolution, ElementsAre(4, 8, 16));
    // The means are 0.2, 0 and 0.05; the deviations 0.1, 0.02 and 0.01 times sqrt 2.
    EXPECT_THAT(curve.bias, Pointwise(DoubleNear(1e-12), {0.2, 0.05, 0.05}));
    EXPECT_THAT(curve.spread, Pointwise(DoubleNear(1e-12), {std::sqrt(0.02), std::sqrt(0.0008), std::sqrt(0.0002)}));
}

TEST(TradeFit, AStepCostsWhatItChangesInTheSameSamplesAndFurtherOnesNoLess) {
    const TradeCurve curve = fitted(sweep());
    EXPECT_THAT(curve.step, ElementsAre(1e-5, 2e-5, 1e-4, 4e-4));
    EXPECT_THAT(curve.step_error, Pointwise(DoubleNear(1e-12), {0.01, 0.0, 0.03, 0.03}));
}

TEST(TradeFit, FindsTheCostsOfParticlesAndSteps) {
    const TradeCurve curve = fitted(sweep());
    EXPECT_NEAR(curve.particle_step, 4e-8, 1e-12);
    EXPECT_NEAR(curve.bytes[0], 4e7, 1);
    EXPECT_NEAR(curve.bytes[1], 600, 1e-6);
    EXPECT_NEAR(curve.prepare[0], 0.5, 1e-6);
    EXPECT_NEAR(curve.prepare[1], 1e-5, 1e-11);
}

TEST(TradeFit, TheErrorOfASlowLoadIsWhatItAddsAsASquare) {
    std::vector<SweepRow> rows = sweep();
    EXPECT_FALSE(fitted(rows).rate_error);
    for (const char* packing : {"0", "1"}) {
        SweepRow slow = row("shape_factor", 16, 2e-5, packing, 0.13);
        slow.rate = 0.1;
        rows.push_back(slow);
    }
    EXPECT_NEAR(*fitted(rows).rate_error, 0.12, 1e-9);  // sqrt(0.13^2 - 0.05^2)
}

TEST(TradeFit, WhatIsNotSurvivedIsNotProposed) {
    std::vector<SweepRow> rows = sweep();
    SweepRow dead = row("none", 4, 2e-5, "1", 0);
    rows.push_back(dead);
    dead.size = 8;
    dead.step = 4e-4;
    rows.push_back(dead);
    const TradeCurve curve = fitted(rows);
    EXPECT_THAT(curve.resolution, ElementsAre(8, 16));
    EXPECT_THAT(curve.step, ElementsAre(1e-5, 2e-5, 1e-4));
}

TEST(TradeFit, WithoutAReferenceErrorsAreCountedFromTheFinestRunsOfNorton) {
    std::vector<SweepRow> rows;
    for (const double size : {4.0, 8.0})
        for (const double step : {0.01, 0.02})
            for (const char* packing : {"0", "1"})
                rows.push_back(row("foam_stress", size, step, packing, (size == 4 ? 0.1 : 0) + step, "norton"));
    rows.push_back(row("foam_stress", 4, 0.02, "2", 0.12, "norton"));
    const TradeCurve curve = fit_trade(rows, {}, {{"norton", 0.64}}).law.at("norton").curve.at(Quantity::foam_stress);
    EXPECT_NEAR(curve.bias[0], 1.12 / 1.01 - 1, 1e-9);
    // The base step has the error that the finest takes away.
    EXPECT_THAT(curve.step, ElementsAre(0.01, 0.02));
    EXPECT_NEAR(curve.step_error[0], 0, 1e-12);
    EXPECT_NEAR(curve.step_error[1], 1 - 1.01 / 1.02, 1e-9);
}

TEST(TradeFit, ItsTextIsATableThatPlanReads) {
    TradeTable table = fit_trade(sweep(), references, {{"bilin", 0.7}});
    table.name = "of a test";
    table.processor = "none";
    const TradeTable read = parse_trade(trade_text(table), "table.toml");
    EXPECT_EQ(read.name, "of a test");
    const TradeCurve curve = read.law.at("bilin").curve.at(Quantity::shape_factor);
    EXPECT_THAT(curve.bias, Pointwise(DoubleNear(1e-12), {0.2, 0.05, 0.05}));
    EXPECT_FALSE(curve.rate_error);
}

TEST(TradeFit, ReadsResultsAndRefusesWhatIsWrongWithItsLine) {
    const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "results.csv";
    const std::string head =
        "scene,law,size,step,rate,filter,packing,quantity,value,particles,steps,time_step,cpu_solve,cpu_prepare,peak_"
        "bytes";
    const auto write = [&](const std::string& line) { std::ofstream(path) << head << '\n' << line << "\r\n"; };
    write("pore,norton,5,0.02,1,box,3,pore_start,0.05,2000,100,0.1,1.5,2.5,4e7");
    const SweepRow read = read_sweep(path).at(0);
    EXPECT_EQ(read.scene, "pore");
    EXPECT_EQ(read.law, "norton");
    EXPECT_EQ(read.filter, "box");
    EXPECT_EQ(read.peak_bytes, 4e7);
    write("pore,norton,5,0.02,1,box,3,none,,,,,,,");
    EXPECT_TRUE(std::isnan(read_sweep(path).at(0).value));
    write("pore,norton,5,0.02,1,box,3,pore_start,x,2000,100,0.1,1.5,2.5,4e7");
    EXPECT_THAT([&] { read_sweep(path); }, ThrowsMessage<InvalidInput>(HasSubstr("line 2: value 'x' is not a number")));
    write("pore,maxwell,5,0.02,1,box,3,none,,,,,,,");
    EXPECT_THAT([&] { read_sweep(path); }, ThrowsMessage<InvalidInput>(HasSubstr("there is no law 'maxwell'")));
}

}  // namespace
}  // namespace tomodem::plan
