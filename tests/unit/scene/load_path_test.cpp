#include "core/scene/load_path.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "core/base/polynomial.hpp"

namespace tomodem {
namespace {

Scene scene(const std::string& load, const std::string& rest = "") {
    return parse_scene(
        "[phase.a]\nlabel = 1\nlaw = \"bilin\"\nnorton = { K = 95.9, M = 2.45e-3 }\n" + rest + "[load]\n" + load,
        "test");
}

Model stepping(double time_step) {
    Model model{};
    model.time_step = time_step;
    return model;
}

Model quasi_static(double strain_per_step) {
    Model model{};
    model.scheme = Scheme::quasi_static;
    model.strain_per_step = strain_per_step;
    return model;
}

double duration_of(const LoadSegment& segment) {
    return static_cast<double>(segment.steps) * segment.time_step;
}

TEST(Polynomial, FindsTheRootsOfACubicInAnInterval) {
    const std::vector<double> cubic{-6, 11, -6, 1};  // (t - 1)(t - 2)(t - 3)
    EXPECT_THAT(polynomial::sign_changes(cubic, 0, 10),
                testing::ElementsAre(testing::DoubleNear(1, 1e-14), testing::DoubleNear(2, 1e-14),
                                     testing::DoubleNear(3, 1e-14)));
    EXPECT_EQ(polynomial::sign_changes(cubic, 1.5, 2.5).size(), 1u);
}

TEST(Polynomial, OfPositiveCoefficientsNeverEnds) {
    EXPECT_FALSE(polynomial::end_of_positive(std::vector{1e-3, 2e-6}).has_value());
    EXPECT_FALSE(polynomial::end_of_positive(std::vector{1e-3, -2e-3, 1.1e-3}).has_value());  // lowest above zero
    EXPECT_NEAR(*polynomial::end_of_positive(std::vector{1e-3, -2e-6, 0.0}), 500, 1e-10);
}

TEST(Polynomial, ReachesAnIntegralWhereItsPrimitiveDoes) {
    const std::vector<double> rate{1e-3, 2e-6};  // integral 1e-3 t + 1e-6 t^2
    EXPECT_NEAR(*polynomial::time_to_reach(rate, 0.02 + 0.0004), 20, 1e-11);
    EXPECT_NEAR(polynomial::largest_magnitude(rate, 20), 1.04e-3, 1e-15);
    const std::vector<double> falling{1e-3, -2e-6};  // at most 0.25, after 500 s
    EXPECT_FALSE(polynomial::time_to_reach(falling, 0.26).has_value());
    EXPECT_TRUE(polynomial::time_to_reach(falling, 0.2499).has_value());
}

TEST(Polynomial, IsTheSameCountedFromALaterTime) {
    const std::vector<double> cubic{-6, 11, -6, 1};
    EXPECT_THAT(polynomial::from(cubic, 2), testing::ElementsAre(0, -1, 0, 1));  // (s + 1) s (s - 1), s = t - 2
    EXPECT_THAT(polynomial::from(std::vector{3.0}, 2), testing::ElementsAre(3));
}

TEST(LoadPath, TakesWholeStepsThatEndExactlyOnTheTargets) {
    const auto path = load_path(
        scene("steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = [1e-3, 2e-5] } ]"), stepping(0.07));
    ASSERT_EQ(path.size(), 2u);
    EXPECT_EQ(path[0].steps, 1429);  // 100 s
    EXPECT_NEAR(path[0].end_strain(), -0.1, 1e-15);
    EXPECT_EQ(path[1].strain, -0.1);
    EXPECT_NEAR(path[1].end_strain(), -0.3, 1e-15);
    // 1e-3 t + 1e-5 t^2 = 0.2 after 100 s
    EXPECT_EQ(path[1].steps, 1429);
    EXPECT_NEAR(path[1].rate_at(0), -1e-3, 1e-6);
    EXPECT_NEAR(path[1].rate_at(100), -3e-3, 3e-6);
}

TEST(LoadPath, HasTheStrainOfThePolynomialInClosedForm) {
    const LoadSegment segment{.strain = -0.2, .rate = {-1e-3, -2e-6, 3e-9}, .steps = 1000, .time_step = 0.1};
    const double t = 70;
    EXPECT_DOUBLE_EQ(segment.rate_at(t), -1e-3 - 2e-6 * t + 3e-9 * t * t);
    EXPECT_DOUBLE_EQ(segment.strain_at(t), -0.2 - 1e-3 * t - 1e-6 * t * t + 1e-9 * t * t * t);
}

TEST(LoadPath, PutsTheCurvesPointsEquallyInStrainAtAnyRate) {
    const auto path = load_path(scene("steps = [ { strain = -0.3, rate = [1e-3, 1e-4] } ]"), stepping(0.01));
    const auto steps = path[0].curve_steps(0.01);
    ASSERT_EQ(steps.size(), 30u);
    EXPECT_EQ(steps.back(), path[0].steps);
    double last = 0;
    for (const std::int64_t step : steps) {
        const double strain = path[0].strain_at(static_cast<double>(step) * 0.01);
        EXPECT_NEAR(strain - last, -0.01, 1e-4);
        last = strain;
    }
}

TEST(LoadPath, HasNoTwoCurvePointsOnOneStep) {
    const auto path = load_path(scene("steps = [ { strain = -0.01, rate = 1e-2 } ]"), stepping(0.1));
    EXPECT_THAT(path[0].curve_steps(1e-4), testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
}

TEST(LoadPath, InitiatesAFlowWithASmoothRise) {
    const auto path = load_path(scene("steps = [ { strain = -0.2, rate = 1e-3 }, { strain = -0.4, rate = 3e-3 } ]\n"
                                      "initiation = { strain = 0.02, noise = 0.1 }"),
                                stepping(1e-2));
    ASSERT_EQ(path.size(), 4u);
    EXPECT_TRUE(path[0].initiates && path[2].initiates && !path[1].initiates && !path[3].initiates);
    double strain = 0, rate = 0;
    for (const LoadSegment& segment : path) {
        EXPECT_NEAR(segment.strain, strain, 1e-15);
        EXPECT_NEAR(segment.rate_at(0), rate, 1e-6) << "the rate jumps";
        const double end = static_cast<double>(segment.steps) * segment.time_step;
        if (segment.initiates) {
            EXPECT_NEAR(std::abs(segment.end_strain() - strain), 0.02, 1e-4);
            EXPECT_NEAR(polynomial::value(polynomial::derivative(segment.rate), 0), 0, 1e-18);
            EXPECT_NEAR(polynomial::value(polynomial::derivative(segment.rate), end), 0, 1e-15);
        }
        strain = segment.end_strain();
        rate = segment.rate_at(end);
    }
    EXPECT_NEAR(strain, -0.4, 1e-15);
    EXPECT_NEAR(rate, -3e-3, 1e-6);
}

TEST(LoadPath, OfAQuasiStaticRunHasTimeStepsThatFollowTheRate) {
    const auto path = load_path(scene("steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.305, rate = 1 } ]"),
                                quasi_static(0.01));
    ASSERT_EQ(path.size(), 2u);
    EXPECT_EQ(path[0].steps, 10);
    EXPECT_DOUBLE_EQ(path[0].time_step, 10);
    EXPECT_EQ(path[1].steps, 21) << "rounded up: no step is longer than asked for";
    EXPECT_DOUBLE_EQ(path[1].time_step, 0.205 / 21);
    EXPECT_NEAR(path[1].end_strain(), -0.305, 1e-15);
}

TEST(LoadPath, OfAQuasiStaticRunIsCutWhereThePolynomialLeavesAFactorOfTwo) {
    struct Load {
        const char* rate;
        double strain;
        std::size_t segments;
    };
    // Rising 1000 fold, falling to nearly zero, both ways with a hump, and one that stays within a factor of two.
    for (const auto& [rate, change, segments] : {Load{"[1e-6, 1e-6]", 0.4, 4}, Load{"[1e-3, -1e-6]", 0.499999, 4},
                                                 Load{"[1e-3, 1e-4, -1e-6]", 0.26, 3}, Load{"[1e-3, 1e-6]", 0.3, 1}}) {
        const std::string load = fmt::format("steps = [ {{ strain = -{}, rate = {} }} ]", change, rate);
        const Scene wanted = scene(load);
        const auto path = load_path(wanted, quasi_static(8e-3));
        EXPECT_EQ(path.size(), segments) << rate;
        double strain = 0, time = 0, highest = 0;
        for (const LoadSegment& segment : path)
            highest = std::max(highest, polynomial::largest_magnitude(segment.rate, duration_of(segment)));
        for (const LoadSegment& segment : path) {
            EXPECT_NEAR(segment.strain, strain, 1e-13) << rate;
            EXPECT_NEAR(-segment.rate_at(0), polynomial::value(wanted.steps[0].rate, time), 1e-9 * highest) << rate;
            double fastest = 0, slowest = 1e300, reached = segment.strain;
            for (std::int64_t step = 1; step <= segment.steps; ++step) {
                const double at = segment.strain_at(segment.time_step * static_cast<double>(step));
                EXPECT_LE(std::abs(at - reached), 8e-3 * (1 + 1e-8)) << rate;
                fastest = std::max(fastest, std::abs(at - reached));
                slowest = std::min(slowest, std::abs(at - reached));
                reached = at;
            }
            if (polynomial::largest_magnitude(segment.rate, duration_of(segment)) > 0.126 * highest)
                EXPECT_LE(fastest, 2.0001 * slowest) << rate;
            strain = segment.end_strain();
            time += duration_of(segment);
        }
        EXPECT_NEAR(strain, -change, 1e-13) << rate;
        EXPECT_NEAR(time, *polynomial::time_to_reach(wanted.steps[0].rate, change), 1e-9 * time) << rate;
    }
}

TEST(LoadPath, OfAQuasiStaticRunOfWallsAloneTakesStepsOfTheNominalStrain) {
    const auto path =
        load_path(scene("duration = \"2 min\"\nrate = 1e-3", "[[wall]]\nname = \"tool\"\nsurface = \"tool.stl\"\n"),
                  quasi_static(0.008));
    ASSERT_EQ(path.size(), 1u);
    EXPECT_EQ(path[0].steps, 15);
    EXPECT_DOUBLE_EQ(path[0].time_step, 8);
}

TEST(LoadClock, GoesOnWhereTheStepsChangeTheirLength) {
    const auto path =
        load_path(scene("steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = 1 } ]"), quasi_static(0.01));
    const auto clocks = clocks_of(path);
    ASSERT_EQ(clocks.size(), 2u);
    EXPECT_DOUBLE_EQ(clocks[0].at(4), 40);
    EXPECT_DOUBLE_EQ(clocks[1].at(10), 100);
    EXPECT_DOUBLE_EQ(clocks[1].at(15), 100.05);
    EXPECT_EQ(LoadClock{}.at(1000), 0) << "a clock that nothing has set stands still";
}

TEST(LoadClock, OfEqualStepsIsTheirNumberTimesTheirLengthToTheLastDigit) {
    const auto path =
        load_path(scene("steps = [ { strain = -0.1, rate = 1e-3 }, { strain = -0.3, rate = 3e-3 } ]"), stepping(0.007));
    const auto clocks = clocks_of(path);
    for (const std::int64_t step : {14286, 14287, 20001, 23333})
        EXPECT_EQ(clocks[1].at(step), 0.007 * static_cast<double>(step));
}

TEST(LoadPath, OfWallsAloneLastsTheDuration) {
    const auto path =
        load_path(scene("duration = \"2 min\"\nrate = 1e-3", "[[wall]]\nname = \"tool\"\nsurface = \"tool.stl\"\n"),
                  stepping(0.01));
    ASSERT_EQ(path.size(), 1u);
    EXPECT_EQ(path[0].steps, 12000);
    EXPECT_NEAR(path[0].end_strain(), 0.12, 1e-15);
}

}  // namespace
}  // namespace tomodem
