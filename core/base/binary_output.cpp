#include "core/base/binary_output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "core/base/error.hpp"

namespace tomodem {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path) {
    const int code = errno;
    throw InvalidInput(fmt::format("cannot write '{}': {}", path.string(),
                                   code != 0 ? std::system_category().message(code) : "writing failed"));
}

}  // namespace

BinaryOutput::BinaryOutput(const std::filesystem::path& path) : final_(path), file_(path), buffer_(1 << 20) {
    errno = 0;
    stream_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    stream_.open(file_.path(), std::ios::binary | std::ios::trunc);
    if (!stream_) fail(final_);
}

void BinaryOutput::text(std::string_view text) {
    bytes(text.data(), text.size());
}

void BinaryOutput::bytes(const void* data, std::size_t size) {
    errno = 0;
    if (!stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size))) fail(final_);
}

void BinaryOutput::commit() {
    errno = 0;
    stream_.close();
    if (!stream_) fail(final_);
    file_.commit();
}

}  // namespace tomodem
