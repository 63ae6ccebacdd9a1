#include "tools/render/appearance.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

namespace tomodem::render {
namespace {

std::vector<double> from_to(double low, double high, int count = 1001) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) values[static_cast<std::size_t>(k)] = low + (high - low) * k / (count - 1);
    return values;
}

TEST(RangeOfColours, LeavesOutAHundredthAtEachEnd) {
    RangeFinder finder;
    finder.add(from_to(0, 1000));
    const ColourRange range = finder.range({}).value();
    EXPECT_EQ(range.low, 10);
    EXPECT_EQ(range.high, 990);
    EXPECT_EQ(range.map, ColourMap::sequential);
    EXPECT_TRUE(range.lower_values);
    EXPECT_TRUE(range.higher_values);
}

TEST(RangeOfColours, IsTheWidestOfAllFrames) {
    RangeFinder finder;
    finder.add(from_to(5, 6));
    finder.add(from_to(4, 5));
    const ColourRange range = finder.range({}).value();
    EXPECT_NEAR(range.low, 4.01, 1e-9);
    EXPECT_NEAR(range.high, 5.99, 1e-9);
}

TEST(RangeOfColours, AroundZeroIsAsLongOnBothSides) {
    RangeFinder finder;
    finder.add(from_to(-300, 100));
    const ColourRange range = finder.range({}).value();
    EXPECT_NEAR(range.low, -296, 1e-9);
    EXPECT_NEAR(range.high, 296, 1e-9);
    EXPECT_EQ(range.map, ColourMap::diverging);
    EXPECT_FALSE(range.higher_values);
}

TEST(RangeOfColours, ThatIsGivenIsUsed) {
    RangeFinder finder;
    finder.add(from_to(-300, 100));
    const ColourRange range = finder.range(std::pair{-500.0, 50.0}).value();
    EXPECT_EQ(range.low, -500);
    EXPECT_EQ(range.high, 50);
    EXPECT_FALSE(range.lower_values);
    EXPECT_TRUE(range.higher_values);
}

TEST(RangeOfColours, OfOneValueHasItInTheMiddle) {
    RangeFinder finder;
    finder.add(std::vector<double>(10, 7.0));
    const ColourRange range = finder.range({}).value();
    EXPECT_LT(range.low, 7);
    EXPECT_NEAR((range.low + range.high) / 2, 7, 1e-12);
}

TEST(RangeOfColours, DoesNotLookAtWhatIsNotANumber) {
    RangeFinder finder;
    finder.add({std::nan(""), std::nan("")});
    EXPECT_FALSE(finder.range({}));
    finder.add({std::nan(""), 1, 2, INFINITY});
    EXPECT_EQ(finder.range({}).value().low, 1);
}

TEST(ColoursOfValues, AreGreyWhereThereIsNone) {
    const auto colours = value_colours({0.0, std::nan("")}, {0, 1, ColourMap::sequential});
    EXPECT_NE(colours[0].red, colours[0].blue);
    EXPECT_EQ(colours[1].red, colours[1].blue);
    EXPECT_EQ(colours[1].red, colours[1].green);
}

TEST(BarOfColours, IsInAUnitOfShortNumbers) {
    const ColourBar bar = colour_bar_of({-4e8, 4e8, ColourMap::diverging}, "stress zz", "Pa");
    EXPECT_EQ(bar.title, "stress zz [MPa]");
    EXPECT_DOUBLE_EQ(bar.high, 400);
    EXPECT_EQ(colour_bar_of({0, 0.05}, "outward", "mm").title, "outward [µm]");
    EXPECT_EQ(colour_bar_of({0, 1}, "share", "").title, "share");
    EXPECT_EQ(value_text(2300, "kg"), "2.3e+03 kg");
}

}  // namespace
}  // namespace tomodem::render
