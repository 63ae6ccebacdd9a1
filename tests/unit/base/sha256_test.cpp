#include "core/base/sha256.hpp"

#include <gmock/gmock.h>

#include <array>

namespace tomodem {
namespace {

TEST(Sha256, OfBytesInPiecesIsThatOfThemAll) {
    Sha256 digest;
    for (const char* part : {"abcdbcdecdefdefgefghfghighijhijkijkl", "", "jklmklmnlmnomnopnopq"})
        digest.add_all(std::string(part));  // FIPS 180-2, appendix B.2
    EXPECT_EQ(digest.hexadecimal(), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, OfNumbersIsThatOfTheirBytes) {
    Sha256 numbers, letters;
    numbers.add_all(std::array<std::uint32_t, 1>{0x00636261});
    letters.add_all(std::string("abc") + '\0');
    EXPECT_EQ(numbers.hexadecimal(), letters.hexadecimal());
}

}  // namespace
}  // namespace tomodem
