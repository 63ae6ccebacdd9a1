#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

/// A folder of its own for each test, removed at its end.
class ScratchFolder : public testing::Test {
 protected:
    ScratchFolder() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = std::filesystem::temp_directory_path() / (std::string("tomodem-") + test->test_suite_name() + "-" +
                                                           test->name() + "-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
    }
    ~ScratchFolder() override { std::filesystem::remove_all(folder); }
    std::filesystem::path folder;
};
