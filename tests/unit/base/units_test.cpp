#include "core/base/units.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Units, OfALengthArriveInMillimetresWithoutRounding) {
    EXPECT_EQ(units::length("2.4um"), 0.0024);
    EXPECT_EQ(units::length("2.4 um"), 0.0024);
    EXPECT_EQ(units::length(" 2.4 µm "), 0.0024);
    EXPECT_EQ(units::length("2.4μm"), 0.0024);
    EXPECT_EQ(units::length("350nm"), 3.5e-4);
    EXPECT_EQ(units::length("+1e-1cm"), 1.0);
    EXPECT_EQ(units::length("0.5mm"), 0.5);
    EXPECT_EQ(units::length("-2m"), -2000.0);
}

TEST(Units, OfOtherMeasuresArriveInMillimetreGramSecond) {
    EXPECT_EQ(units::time("10ms"), 0.01);
    EXPECT_EQ(units::time("2min"), 120.0);
    EXPECT_EQ(units::time("1 h"), 3600.0);
    EXPECT_EQ(units::rate("1e-3 1/s"), 1e-3);
    EXPECT_EQ(units::rate("1e-3s^-1"), 1e-3);
    EXPECT_EQ(units::stiffness("1 N/m"), 1e3);  // 1e6 uN over 1e3 mm
    EXPECT_EQ(units::stiffness("1N/mm"), 1e6);
    EXPECT_EQ(units::stress("30MPa"), 30e6);  // 1 Pa = 1 uN/mm^2
    EXPECT_EQ(units::mass("1.5kg"), 1500.0);
}

TEST(Units, RejectANumberWithoutUnitAndSayHowToWriteIt) {
    EXPECT_THAT([] { units::length("2.4"); },
                ThrowsMessage<InvalidInput>("length '2.4' has no unit: write for example 2.4um or 0.0024mm"));
    EXPECT_THAT([] { units::rate("1e-3"); },
                ThrowsMessage<InvalidInput>("rate '1e-3' has no unit: write for example 1e-3 s^-1 or 0.001 1/s"));
}

TEST(Units, RejectTheUnitOfAnotherMeasure) {
    EXPECT_THAT(
        [] { units::length("3s"); },
        ThrowsMessage<InvalidInput>("length '3s': 's' measures a time; a length is given in nm, um, mm, cm, m"));
}

TEST(Units, RejectAnUnknownUnit) {
    EXPECT_THAT([] { units::length("3 inches"); }, ThrowsMessage<InvalidInput>(HasSubstr("unknown unit 'inches'")));
    EXPECT_THAT([] { units::length("1.2.3mm"); }, ThrowsMessage<InvalidInput>(HasSubstr("unknown unit '.3mm'")));
}

TEST(Units, RejectWhatTheSpacelessRateWouldMisread) {
    // "1e-3" followed by "1/s" without a space is the number 1e-31.
    EXPECT_THAT([] { units::rate("1e-31/s"); }, ThrowsMessage<InvalidInput>(HasSubstr("unknown unit '/s'")));
}

TEST(Units, RejectTextThatIsNoNumber) {
    for (const char* text : {"", "  ", "um", "nan mm", "inf mm", "--1mm"})
        EXPECT_THAT([&] { units::length(text); }, ThrowsMessage<InvalidInput>(HasSubstr("is not a number"))) << text;
    EXPECT_THAT([] { units::length("1e999mm"); }, ThrowsMessage<InvalidInput>(HasSubstr("out of the range")));
}

}  // namespace
}  // namespace tomodem
