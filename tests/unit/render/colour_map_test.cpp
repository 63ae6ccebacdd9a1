#include "tools/render/colour_map.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace tomodem::render {
namespace {

double distance(const Rgb& a, const Rgb& b) {
    const auto p = oklab(a), q = oklab(b);
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(Oklab, OfWhiteIsLightnessOneWithoutColour) {
    const auto white = oklab({255, 255, 255});
    EXPECT_NEAR(white[0], 1, 1e-6);
    EXPECT_NEAR(white[1], 0, 1e-4);
    EXPECT_NEAR(white[2], 0, 1e-4);
}

TEST(SequentialColours, GrowLighterEvenly) {
    constexpr int steps = 64;
    const double whole = oklab(colour_at(ColourMap::sequential, 1))[0] - oklab(colour_at(ColourMap::sequential, 0))[0];
    EXPECT_GT(whole, 0.6);
    for (int k = 0; k <= steps; ++k) {
        const double place = double(k) / steps;
        const double lightness = oklab(colour_at(ColourMap::sequential, place))[0];
        EXPECT_NEAR(lightness, oklab(colour_at(ColourMap::sequential, 0))[0] + place * whole, 0.01);
    }
}

TEST(SequentialColours, DifferByTheSameFromStepToStep) {
    constexpr int steps = 16;
    std::vector<double> differences;
    for (int k = 0; k < steps; ++k)
        differences.push_back(distance(colour_at(ColourMap::sequential, double(k) / steps),
                                       colour_at(ColourMap::sequential, double(k + 1) / steps)));
    double mean = 0;
    for (const double one : differences) mean += one / steps;
    for (const double one : differences) EXPECT_NEAR(one, mean, 0.3 * mean);
}

TEST(DivergingColours, AreNeutralInTheMiddleAndAsDarkAtBothEnds) {
    const auto low = oklab(colour_at(ColourMap::diverging, 0)), middle = oklab(colour_at(ColourMap::diverging, 0.5)),
               high = oklab(colour_at(ColourMap::diverging, 1));
    EXPECT_NEAR(std::hypot(middle[1], middle[2]), 0, 0.005);
    EXPECT_NEAR(low[0], high[0], 0.01);
    EXPECT_LT(low[2], -0.1);
    EXPECT_GT(high[1], 0.1);
    for (const double away : {0.1, 0.25, 0.4})
        EXPECT_NEAR(distance(colour_at(ColourMap::diverging, 0.5 - away), colour_at(ColourMap::diverging, 0.5)),
                    distance(colour_at(ColourMap::diverging, 0.5 + away), colour_at(ColourMap::diverging, 0.5)), 0.02);
}

TEST(Colours, BeyondTheEndsAreThoseOfTheEnds) {
    for (const auto map : {ColourMap::sequential, ColourMap::diverging}) {
        EXPECT_EQ(distance(colour_at(map, -3), colour_at(map, 0)), 0);
        EXPECT_EQ(distance(colour_at(map, 7), colour_at(map, 1)), 0);
    }
}

}  // namespace
}  // namespace tomodem::render
