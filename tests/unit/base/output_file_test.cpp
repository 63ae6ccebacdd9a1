#include "core/base/output_file.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "tests/unit/file_size_limit.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace tomodem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

class OutputFileTest : public InTemporaryFolder {};

TEST_F(OutputFileTest, AppearsOnlyAtCommit) {
    OutputFile file(folder / "result.csv");
    put(file.path(), "1,2\n");
    EXPECT_EQ(file.path().parent_path(), folder);
    EXPECT_EQ(file.path().extension(), ".csv");
    EXPECT_FALSE(std::filesystem::exists(folder / "result.csv"));
    file.commit();
    EXPECT_THAT(names(), ElementsAre("result.csv"));
    EXPECT_EQ(content(folder / "result.csv"), "1,2\n");
}

TEST_F(OutputFileTest, LeavesTheOldFileWhenNotCommitted) {
    write_text(folder / "result.csv", "old");
    {
        OutputFile file(folder / "result.csv");
        put(file.path(), "new");
    }
    EXPECT_THAT(names(), ElementsAre("result.csv"));
    EXPECT_EQ(content(folder / "result.csv"), "old");
}

TEST_F(OutputFileTest, ReplacesTheTargetOfALinkAndKeepsTheLink) {
    write_text(folder / "target", "old");
    std::filesystem::create_symlink("target", folder / "link");
    write_text(folder / "link", "new");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_EQ(content(folder / "target"), "new");
}

TEST_F(OutputFileTest, RejectsAMissingFolder) {
    EXPECT_THAT([&] { OutputFile(folder / "none" / "a.h5"); },
                ThrowsMessage<InvalidInput>(HasSubstr("there is no folder")));
}

TEST_F(OutputFileTest, RejectsAFolderAsItsName) {
    EXPECT_THAT([&] { OutputFile{folder}; }, ThrowsMessage<InvalidInput>(HasSubstr("it is a folder")));
}

TEST_F(OutputFileTest, RejectsADevice) {
    EXPECT_THAT([] { OutputFile("/dev/null"); }, ThrowsMessage<InvalidInput>(HasSubstr("not a regular file")));
}

TEST_F(OutputFileTest, RejectsAFolderWithoutWritePermission) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    std::filesystem::permissions(folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_THAT([&] { OutputFile(folder / "a"); }, ThrowsMessage<InvalidInput>(HasSubstr("no permission")));
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
}

TEST_F(OutputFileTest, LeavesNothingBehindWhenTheDiskIsFull) {
    {
        const FileSizeLimit limit(10);
        EXPECT_THAT([&] { write_text(folder / "a.txt", std::string(1000, 'x')); },
                    ThrowsMessage<InvalidInput>(
                        HasSubstr("cannot write '" + (folder / "a.txt").string() + "': File too large")));
    }
    EXPECT_THAT(names(), IsEmpty());
}

TEST_F(OutputFileTest, LeavesNothingBehindWhenTheProcessIsTerminated) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        const pid_t child = ::fork();
        if (child == 0) {
            OutputFile first(folder / "a.csv"), second(folder / "b.csv");
            put(first.path(), "half");
            put(second.path(), "half");
            ::raise(number);
            ::_exit(0);
        }
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number) << status;  // seen as killed, not as failed
        EXPECT_THAT(names(), IsEmpty());
    }
}

TEST_F(OutputFileTest, RejectsACommitOfAFileThatWasNeverWritten) {
    OutputFile file(folder / "a");
    EXPECT_THAT([&] { file.commit(); }, ThrowsMessage<InvalidInput>(HasSubstr("No such file")));
}

}  // namespace
}  // namespace tomodem
