#pragma once
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/output_file.hpp"

namespace tomodem {

static_assert(std::endian::native == std::endian::little, "binary files are written as the numbers lie in memory");

/// A binary or large text file written piece by piece, which appears complete at commit() or not at all.
class BinaryOutput {
 public:
    /// @throws InvalidInput as OutputFile
    explicit BinaryOutput(const std::filesystem::path& path);

    void text(std::string_view text);
    template <class T>
    void values(std::span<const T> values) {
        bytes(values.data(), values.size_bytes());
    }
    template <class T>
    void value(const T& value) {
        bytes(&value, sizeof value);
    }
    /// @throws InvalidInput if anything could not be written (disk full)
    void commit();

 private:
    void bytes(const void* data, std::size_t size);
    std::filesystem::path final_;
    OutputFile file_;
    std::vector<char> buffer_;
    std::ofstream stream_;
};

}  // namespace tomodem
