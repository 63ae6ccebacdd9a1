#include "core/base/provenance.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class ContentDigest : public InTemporaryFolder {};

TEST_F(ContentDigest, OfAFileIsItsSha256) {
    put(folder / "abc", "abc");  // FIPS 180-2, appendix B.1
    EXPECT_EQ(content_digest(folder / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    put(folder / "million", std::string(1'000'000, 'a'));  // appendix B.3
    EXPECT_EQ(content_digest(folder / "million"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    put(folder / "empty", "");
    EXPECT_EQ(content_digest(folder / "empty"), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_F(ContentDigest, OfAFolderDependsOnNamesAndContentsOfItsFilesOnly) {
    put(folder / "slice_1.tif", "one");
    put(folder / "slice_2.tif", "two");
    const std::string before = content_digest(folder);
    std::filesystem::create_directory(folder / "other");
    EXPECT_EQ(content_digest(folder), before);
    std::filesystem::rename(folder / "slice_2.tif", folder / "slice_3.tif");
    EXPECT_NE(content_digest(folder), before);
    std::filesystem::rename(folder / "slice_3.tif", folder / "slice_2.tif");
    EXPECT_EQ(content_digest(folder), before);
    put(folder / "slice_2.tif", "twO");
    EXPECT_NE(content_digest(folder), before);
}

TEST_F(ContentDigest, RejectsAMissingFile) {
    EXPECT_THAT([&] { content_digest(folder / "none"); }, ThrowsMessage<InvalidInput>(HasSubstr("no such file")));
}

}  // namespace
}  // namespace tomodem
