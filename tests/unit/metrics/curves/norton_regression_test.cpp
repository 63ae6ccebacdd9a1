#include "tools/metrics/curves/norton_regression.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/base/error.hpp"

namespace tomodem::curves {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(NortonFit, FindsTheLawThatMadeTheStresses) {
    const std::vector<double> rate{1e-4, 2.15e-4, 4.64e-4, 1e-3};
    std::vector<double> stress;
    for (const double r : rate) stress.push_back(5020.0 * std::pow(r, 0.49));
    const NortonFit fit = norton_fit(rate, stress);
    EXPECT_NEAR(fit.K, 5020.0, 1e-8);
    EXPECT_NEAR(fit.M, 0.49, 1e-12);
    EXPECT_NEAR(fit.M_interval->low, fit.M_interval->high, 1e-10);
    EXPECT_NEAR(fit.residual, 0.0, 1e-12);
}

TEST(NortonFit, HasTheIntervalOfATextbookLine) {
    // ln rate = -1, 0, 1 and ln stress = 0, 0.1, 0.1: slope 0.05, residuals -1/60, 1/30, -1/60, so s^2 = 1/600,
    // t(0.95, 1) = 12.7062.
    const std::vector<double> rate{std::exp(-1.0), 1.0, std::exp(1.0)};
    const std::vector<double> stress{1.0, std::exp(0.1), std::exp(0.1)};
    const NortonFit fit = norton_fit(rate, stress);
    EXPECT_NEAR(fit.M, 0.05, 1e-12);
    EXPECT_NEAR(fit.M_interval->high - fit.M, 12.7062 * std::sqrt(1.0 / 600.0 / 2.0), 1e-5);
    EXPECT_NEAR(std::log(fit.K_interval->high / fit.K), 12.7062 * std::sqrt(1.0 / 600.0 / 3.0), 1e-5);
    EXPECT_NEAR(fit.K_interval->high / fit.K, fit.K / fit.K_interval->low, 1e-9);
}

TEST(NortonFit, HoldsTheTrueExponentInNineteenIntervalsOfTwenty) {
    std::mt19937 generator(5);
    std::normal_distribution<double> noise(0.0, 0.03);
    int held = 0;
    constexpr int trials = 4000;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> rate, stress;
        for (int i = 0; i < 6; ++i) {
            rate.push_back(1e-4 * std::pow(10.0, i / 5.0));
            stress.push_back(100.0 * std::pow(rate.back(), 0.1) * std::exp(noise(generator)));
        }
        const NortonFit fit = norton_fit(rate, stress);
        held += fit.M_interval->low <= 0.1 && 0.1 <= fit.M_interval->high;
    }
    EXPECT_NEAR(double(held) / trials, 0.95, 0.012);
}

TEST(NortonFit, OfTwoRunsHasNoInterval) {
    const NortonFit fit = norton_fit(std::vector{1e-4, 1e-3}, std::vector{50.0, 100.0});
    EXPECT_NEAR(fit.M, std::log10(2.0), 1e-12);
    EXPECT_FALSE(fit.M_interval.has_value());
    EXPECT_FALSE(fit.K_interval.has_value());
}

TEST(NortonFit, RejectsOneRun) {
    EXPECT_THAT([] { norton_fit(std::vector{1e-4}, std::vector{50.0}); },
                ThrowsMessage<InvalidInput>(HasSubstr("at least two runs")));
}

TEST(NortonFit, RejectsRunsOfOneRate) {
    EXPECT_THAT(
        [] {
            norton_fit(std::vector{1e-4, 1.0001e-4}, std::vector{50.0, 60.0});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("different rates")));
}

TEST(NortonFit, RejectsAStressOfZero) {
    EXPECT_THAT(
        [] {
            norton_fit(std::vector{1e-4, 1e-3}, std::vector{50.0, 0.0});
        },
        ThrowsMessage<InvalidInput>(HasSubstr("run 2")));
}

TEST(StudentT, EqualsTheTables) {
    EXPECT_NEAR(student_t(0.95, 1), 12.7062, 5e-5);
    EXPECT_NEAR(student_t(0.95, 2), 4.30265, 5e-6);
    EXPECT_NEAR(student_t(0.95, 3), 3.18245, 5e-6);
    EXPECT_NEAR(student_t(0.95, 4), 2.77645, 5e-6);
    EXPECT_NEAR(student_t(0.95, 9), 2.26216, 5e-6);
    EXPECT_NEAR(student_t(0.95, 30), 2.04227, 5e-6);
}

}  // namespace
}  // namespace tomodem::curves
