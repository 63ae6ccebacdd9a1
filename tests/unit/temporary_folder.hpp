#pragma once
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace tomodem {

/// A test with an empty folder of its own.
class InTemporaryFolder : public testing::Test {
 protected:
    InTemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "tomodem-test-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        folder = name;
    }
    ~InTemporaryFolder() override { std::filesystem::remove_all(folder); }

    std::set<std::string> names() const {
        std::set<std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) all.insert(entry.path().filename());
        return all;
    }
    static std::string content(const std::filesystem::path& path) {
        std::ostringstream text;
        text << std::ifstream(path, std::ios::binary).rdbuf();
        return text.str();
    }
    static void put(const std::filesystem::path& path, const std::string& text) {
        std::ofstream(path, std::ios::binary) << text;
    }

    std::filesystem::path folder;
};

}  // namespace tomodem
