#include "core/cli/frames_cli.hpp"

#include <gmock/gmock.h>

#include "core/base/error.hpp"

namespace tomodem::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ChosenFrames, AreSeveralInIncreasingOrder) {
    EXPECT_THAT(chosen_frames("0,5,last", 31), ElementsAre(0, 5, 30));
    EXPECT_THAT(chosen_frames("first,last", 2), ElementsAre(0, 1));
    for (const char* words : {"5,0", "3,3", "last,0", "all,3"})
        EXPECT_THAT([words] { chosen_frames(words, 31); },
                    testing::ThrowsMessage<WrongUsage>(HasSubstr("give each frame once, in increasing order")));
    EXPECT_THAT([] { chosen_frames("0,31", 31); },
                testing::ThrowsMessage<InvalidInput>(HasSubstr("--frames 31: the file has frames 0 to 30")));
    for (const char* words : {"0,", ",3", "0,x", "0,,3"}) EXPECT_THROW(chosen_frames(words, 31), WrongUsage) << words;
}

}  // namespace
}  // namespace tomodem::cli
