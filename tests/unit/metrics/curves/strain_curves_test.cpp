#include "tools/metrics/curves/strain_curves.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "core/base/error.hpp"
#include "tests/unit/metrics/synthetic_run.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem::curves {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class StrainCurvesFile : public InTemporaryFolder {
 protected:
    /// A run whose one curve besides the strain is given by its points (time, value).
    std::filesystem::path run(const std::vector<std::pair<double, double>>& points, const std::string& unit = "Pa") {
        const Packing packing = synthetic::sample(synthetic::cube(1, 1.0));
        const auto path = folder / "run.h5";
        RunWriter writer(packing, path, {});
        writer.add_frame({0, 0.0, packing.position});
        for (int i = 0; i <= 10; ++i) writer.add_observable("strain", "", i, 10.0 * i, -0.01 * i);
        for (const auto& [time, value] : points) writer.add_observable("stress_true", unit, 0, time, value);
        writer.commit();
        return path;
    }
};

StrainCurves curves_of(const std::vector<double>& strain, const std::function<double(double)>& stress) {
    StrainCurves curves;
    curves.strain = strain;
    for (std::size_t i = 0; i < strain.size(); ++i) {
        curves.time.push_back(10.0 * double(i));
        curves.value["stress_true"].push_back(stress(strain[i]));
    }
    return curves;
}

/// Equal steps through the turning points.
std::vector<double> through(const std::vector<double>& turning_points, double step) {
    std::vector<double> strain{turning_points.front()};
    for (std::size_t i = 1; i < turning_points.size(); ++i) {
        const double from = turning_points[i - 1], to = turning_points[i];
        const int steps = int(std::lround(std::abs(to - from) / step));
        for (int k = 1; k <= steps; ++k) strain.push_back(from + (to - from) * k / steps);
    }
    return strain;
}

TEST_F(StrainCurvesFile, TakesACurveOfOtherTimesByInterpolation) {
    const StrainCurves curves = read_strain_curves(run({{0.0, 0.0}, {100.0, -200.0}}), {{"stress_true", "Pa"}});
    ASSERT_EQ(curves.strain.size(), 11u);
    EXPECT_NEAR(curves.value.at("stress_true")[3], -60.0, 1e-12);
}

TEST_F(StrainCurvesFile, RejectsACurveThatIsNotThereAndNamesThoseThatAre) {
    const auto path = run({{0.0, 0.0}});
    EXPECT_THAT(
        [&] {
            read_strain_curves(path, {{"force_top", "uN"}});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("no curve 'force_top'")));
}

TEST_F(StrainCurvesFile, RejectsAnotherUnit) {
    const auto path = run({{0.0, 0.0}}, "MPa");
    EXPECT_THAT(
        [&] {
            read_strain_curves(path, {{"stress_true", "Pa"}});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("is in 'MPa', expected 'Pa'")));
}

TEST_F(StrainCurvesFile, RejectsAValueThatIsNotFinite) {
    const auto path = run({{0.0, 0.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}});
    EXPECT_THAT(
        [&] {
            read_strain_curves(path, {{"stress_true", "Pa"}});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("point 1")));
}

TEST_F(StrainCurvesFile, RejectsASample) {
    const auto path = folder / "sample.h5";
    write_packing(synthetic::sample(synthetic::cube(1, 1.0)), path, {});
    EXPECT_THAT([&] { read_strain_curves(path, {}); }, ThrowsMessage<InvalidInput>(HasSubstr("give a run")));
}

TEST_F(StrainCurvesFile, FindTheStrainOfAFrame) {
    const RunReader reader(run({{0.0, 0.0}}));
    EXPECT_EQ(frame_strain(reader, 0), 0.0);
    const auto sample = folder / "sample.h5";
    write_packing(synthetic::sample(synthetic::cube(1, 1.0)), sample, {});
    EXPECT_EQ(frame_strain(RunReader(sample), 0), 0.0);
}

TEST(PiecewiseLinear, HasTheMeanOfItsTrapezes) {
    const std::vector<double> x{0, 1, 1, 3}, y{0, 2, 4, 0};  // a jump at 1
    const PiecewiseLinear curve(x, y);
    EXPECT_DOUBLE_EQ(curve.mean(0, 3), (1.0 + 4.0) / 3.0);
    EXPECT_DOUBLE_EQ(curve.mean(0.5, 2.0), (0.75 + 3.0) / 1.5);
    EXPECT_DOUBLE_EQ(curve.mean(2, 2), 2.0);
    EXPECT_DOUBLE_EQ(curve.at(0.25), 0.5);
    EXPECT_DOUBLE_EQ(curve.at(3.0), 0.0);
}

TEST(Legs, EndWhereTheStrainTurns) {
    const std::vector<double> strain{0, -0.1, -0.1, -0.2, -0.1, 0.1, 0.0};
    const std::vector<Leg> found = legs(strain);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].last, 3u) << "a hold does not end a leg";
    EXPECT_EQ(found[1].first, 3u);
    EXPECT_EQ(found[1].last, 5u);
    EXPECT_EQ(found[2].last, 6u);
}

TEST(AveragedOverStrain, LeavesAStraightLineAsItIs) {
    const StrainCurves line = curves_of(through({0, -0.3}, 0.001), [](double e) { return 5e8 * e - 1e6; });
    const StrainCurves averaged = averaged_over_strain(line, 0.02);
    for (std::size_t i = 0; i < line.strain.size(); ++i)
        EXPECT_NEAR(averaged.value.at("stress_true")[i], 5e8 * averaged.strain[i] - 1e6, 1e-3) << i;
    EXPECT_NEAR(averaged.strain[150], line.strain[150], 1e-12);
    EXPECT_NEAR(averaged.time[150], line.time[150], 1e-9);
    EXPECT_NEAR(averaged.strain.back(), -0.295, 1e-12) << "half a window at the end";
}

TEST(AveragedOverStrain, RemovesAnOscillationOfItsWidth) {
    const StrainCurves wave = curves_of(
        through({0, -0.3}, 0.0005), [](double e) { return -1e8 + 1e7 * std::sin(2 * std::numbers::pi * e / 0.01); });
    const StrainCurves averaged = averaged_over_strain(wave, 0.01);
    for (std::size_t i = 20; i + 20 < wave.strain.size(); ++i)
        EXPECT_NEAR(averaged.value.at("stress_true")[i], -1e8, 1.0);
}

TEST(AveragedOverStrain, DoesNotMixTheTwoSidesOfATurningPoint) {
    StrainCurves curves = curves_of(through({0, -0.1, 0}, 0.001), [](double) { return -1e8; });
    auto& stress = curves.value["stress_true"];
    for (std::size_t i = 101; i < stress.size(); ++i) stress[i] = 1e8;
    const StrainCurves averaged = averaged_over_strain(curves, 0.02);
    EXPECT_NEAR(averaged.value.at("stress_true")[100], -1e8, 1e-3);
    EXPECT_GT(averaged.value.at("stress_true")[120], 0.99e8);
}

TEST(AveragedOverStrain, OfNoWidthIsTheCurveItself) {
    const StrainCurves line = curves_of(through({0, -0.1}, 0.01), [](double e) { return e; });
    EXPECT_EQ(averaged_over_strain(line, 0.0).value, line.value);
}

TEST(Plateau, OfALineIsItsValueInTheMiddle) {
    const StrainCurves line = curves_of(through({0, -0.4}, 0.0013), [](double e) { return 5e8 * e; });
    const Plateau flow = plateau(line, "stress_true", 0.3, 0.05);
    EXPECT_NEAR(flow.mean, 1.5e8, 1.0);
    EXPECT_NEAR(flow.from, 0.25, 1e-12);
    EXPECT_NEAR(flow.to, 0.35, 1e-12);
    EXPECT_NEAR(flow.highest, 1.75e8, 1.0);
    const double step = line.strain[0] - line.strain[1];
    EXPECT_NEAR(flow.rate, step / 10.0, 1e-9);
    EXPECT_NEAR(flow.deviation, 5e8 * 0.1 / std::sqrt(12.0), 0.02 * 5e8 * 0.1 / std::sqrt(12.0));
}

TEST(Plateau, IsCutOffWhereTheRunEnds) {
    const StrainCurves line = curves_of(through({0, -0.3}, 0.001), [](double e) { return 5e8 * e; });
    const Plateau flow = plateau(line, "stress_true", 0.3, 0.05);
    EXPECT_NEAR(flow.to, 0.3, 1e-12);
    EXPECT_NEAR(flow.mean, 5e8 * 0.275, 1.0);
}

TEST(Plateau, IsThatOfTheFirstPassage) {
    const StrainCurves curves =
        curves_of(through({0, 0.1, -0.4, 0.4}, 0.001), [](double e) { return e < 0 ? -1e8 : 3e8; });
    EXPECT_NEAR(plateau(curves, "stress_true", 0.3, 0.05).mean, 1e8, 1.0);
    EXPECT_NEAR(plateau(curves, "stress_true", 0.05, 0.02).mean, 3e8, 1.0);
}

TEST(Plateau, OfTensionIsPositive) {
    const StrainCurves curves = curves_of(through({0, 0.4}, 0.001), [](double) { return 3e8; });
    EXPECT_NEAR(plateau(curves, "stress_true", 0.3, 0.05).mean, 3e8, 1.0);
}

TEST(Plateau, RejectsAStrainThatIsNotReached) {
    const StrainCurves line = curves_of(through({0, -0.2}, 0.001), [](double e) { return e; });
    EXPECT_THAT([&] { plateau(line, "stress_true", 0.3, 0.05); },
                ThrowsMessage<InvalidInput>(HasSubstr("the largest is 0.2")));
}

TEST(MeanBetween, RejectsARangeThatIsNotCovered) {
    const StrainCurves line = curves_of(through({0, -0.2}, 0.001), [](double e) { return e; });
    EXPECT_NEAR(mean_between(line, "stress_true", 0.1, 0.2).mean, 0.15, 1e-12);
    EXPECT_THAT([&] { mean_between(line, "stress_true", 0.1, 0.3); },
                ThrowsMessage<InvalidInput>(HasSubstr("does not go from 0.1 to 0.3")));
    EXPECT_THAT([&] { mean_between(line, "stress_true", 0.2, 0.1); },
                ThrowsMessage<InvalidInput>(HasSubstr("does not go from 0.2 to 0.1")));
}

TEST(EquilibriumError, IsTheSumOverTheMeanForce) {
    EXPECT_DOUBLE_EQ(*equilibrium_error(-101.0, 99.0), 0.02);
    EXPECT_DOUBLE_EQ(*equilibrium_error(5.0, -5.0), 0.0);
    EXPECT_FALSE(equilibrium_error(0.0, 0.0).has_value());
}

TEST(EquilibriumErrors, LeaveOutPointsWithoutForce) {
    StrainCurves forces;
    forces.time = {0, 1, 2};
    forces.strain = {0, -0.1, -0.2};
    forces.value = {{"force_top", {0, -11, -10}}, {"force_bottom", {0, 9, 10}}};
    const StrainCurves errors = equilibrium_errors(forces);
    ASSERT_EQ(errors.strain.size(), 2u);
    EXPECT_DOUBLE_EQ(errors.value.at("equilibrium_error")[0], 0.2);
    forces.value = {{"force_top", {0, 0, 0}}, {"force_bottom", {0, 0, 0}}};
    EXPECT_THAT([&] { equilibrium_errors(forces); }, ThrowsMessage<InvalidInput>(HasSubstr("zero in the whole run")));
}

}  // namespace
}  // namespace tomodem::curves
