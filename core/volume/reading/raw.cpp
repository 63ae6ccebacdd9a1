#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/base/parallel.hpp"
#include "core/volume/reading/reading.hpp"

namespace tomodem::formats {
namespace {

class File {
 public:
    explicit File(const fs::path& path) : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (descriptor_ < 0) cannot_read(path, std::strerror(errno));
    }
    ~File() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    File(File&& other) noexcept : path_(other.path_), descriptor_(std::exchange(other.descriptor_, -1)) {}
    File(const File&) = delete;

    /// May be called by several threads at once.
    void read(std::int64_t at, std::byte* to, std::int64_t count) const {
        while (count > 0) {
            const ssize_t got = pread(descriptor_, to, static_cast<std::size_t>(count), at);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) cannot_read(path_, std::strerror(errno));
            if (got == 0) cannot_read(path_, fmt::format("it ends at byte {}; copy or write it again", at));
            at += got;
            to += got;
            count -= got;
        }
    }

 private:
    fs::path path_;
    int descriptor_;
};

/// Voxels as they lie in memory, in one file or in one file for every few slices.
class RawSource : public VolumeSource {
 public:
    RawSource(VolumeHeader header, const RawVoxels& where) : where_(where) {
        header_ = std::move(header);
        slices_of_a_file_ = header_.size[2] / static_cast<std::int64_t>(where.files.size());
        for (const auto& path : where.files) files_.emplace_back(path);
    }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const auto size = static_cast<std::int64_t>(bytes_of(header_.type));
        const std::int64_t row = header_.size[0] * size, page = row * header_.size[1];
        const std::int64_t wanted_row = window.width * size;
        parallel_for(count, threads_, [&](std::int64_t i) {
            const std::int64_t slice = k + i;
            const File& file = files_[static_cast<std::size_t>(slice / slices_of_a_file_)];
            const std::int64_t start =
                where_.offset + slice % slices_of_a_file_ * page + window.y * row + window.x * size;
            std::byte* const to = voxels + i * wanted_row * window.height;
            if (window.width == header_.size[0])
                file.read(start, to, wanted_row * window.height);
            else
                for (std::int64_t y = 0; y < window.height; ++y)
                    file.read(start + y * row, to + y * wanted_row, wanted_row);
        });
    }

 private:
    RawVoxels where_;
    std::vector<File> files_;
    std::int64_t slices_of_a_file_;
};

/// A compressed file that is read from its start to its end, and again where earlier slices are asked for.
class DeflatedSource : public VolumeSource {
 public:
    DeflatedSource(VolumeHeader header, const RawVoxels& where)
        : where_(where), bytes_(file_bytes(where.files.front())), file_(where.files.front()) {
        header_ = std::move(header);
        page_.resize(static_cast<std::size_t>(header_.size[0]) * header_.size[1] * bytes_of(header_.type));
    }
    ~DeflatedSource() override { stop(); }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        const auto size = static_cast<std::int64_t>(bytes_of(header_.type));
        if (!running_ || k < next_) start();
        while (next_ < k) next_page();
        for (std::int32_t i = 0; i < count; ++i) {
            next_page();
            for (std::int64_t y = 0; y < window.height; ++y, voxels += window.width * size)
                std::memcpy(voxels, page_.data() + ((window.y + y) * header_.size[0] + window.x) * size,
                            static_cast<std::size_t>(window.width * size));
        }
    }

 private:
    void start() {
        stop();
        stream_ = {};
        constexpr int largest_window = 15, zlib_or_gzip = 32;
        if (inflateInit2(&stream_, largest_window + zlib_or_gzip) != Z_OK) throw std::bad_alloc();
        running_ = true;
        at_ = where_.offset;
        next_ = 0;
    }
    void stop() {
        if (running_) inflateEnd(&stream_);
        running_ = false;
    }
    [[noreturn]] void damaged(const std::string& why) {
        cannot_read(where_.files.front(), fmt::format("slice {} is cut or damaged in the compressed data ({}); copy or "
                                                      "write it again",
                                                      next_, why));
    }
    void next_page() {
        stream_.next_out = reinterpret_cast<Bytef*>(page_.data());
        std::size_t left = page_.size();
        while (left > 0) {
            if (stream_.avail_in == 0) {
                const auto count = std::min<std::int64_t>(static_cast<std::int64_t>(input_.size()), bytes_ - at_);
                if (count == 0) damaged("the file ends");
                file_.read(at_, input_.data(), count);
                at_ += count;
                stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
                stream_.avail_in = static_cast<uInt>(count);
            }
            const auto room = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
            stream_.avail_out = room;
            const int status = inflate(&stream_, Z_NO_FLUSH);
            left -= room - stream_.avail_out;
            if (status == Z_STREAM_END && left > 0) {
                // Some writers chain several gzip members.
                if (inflateReset(&stream_) != Z_OK || (stream_.avail_in == 0 && at_ == bytes_))
                    damaged("too few voxels");
            } else if (status != Z_OK && status != Z_STREAM_END) {
                damaged(stream_.msg ? stream_.msg : "no zlib or gzip data");
            }
        }
        ++next_;
    }

    RawVoxels where_;
    std::int64_t bytes_;
    File file_;
    z_stream stream_{};
    bool running_ = false;
    std::int64_t at_ = 0;
    std::int32_t next_ = 0;
    std::vector<std::byte> page_, input_ = std::vector<std::byte>(1 << 18);
};

template <class T>
void swap_bytes_of(std::byte* voxels, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) std::reverse(voxels + i * sizeof(T), voxels + (i + 1) * sizeof(T));
}

/// Turns the voxels of another source to this machine's byte order.
class SwappedSource : public VolumeSource {
 public:
    explicit SwappedSource(Source source) : source_(std::move(source)) { header_ = source_->header(); }

    void use_threads(int threads) override {
        threads_ = threads;
        source_->use_threads(threads);
    }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        source_->read(k, count, window, voxels);
        const std::int64_t page = window.width * window.height;
        with_type(header_.type, [&](auto value) {
            using Value = decltype(value);
            parallel_for(count, threads_, [&](std::int64_t i) {
                swap_bytes_of<Value>(voxels + i * page * static_cast<std::int64_t>(sizeof(Value)), page);
            });
        });
    }

 private:
    Source source_;
};

}  // namespace

Source open_raw(VolumeHeader header, RawVoxels where) {
    check_size(where.files.front(), {header.size[0], header.size[1], header.size[2]});
    const bool swap = where.big_endian && bytes_of(header.type) > 1;
    Source source;
    if (where.deflated) {
        constexpr double most_packed = 1100;  // deflate packs at most 1032 bytes into one
        const double wanted = double(header.size[0]) * header.size[1] * header.size[2] * double(bytes_of(header.type));
        if (wanted > most_packed * static_cast<double>(file_bytes(where.files.front())))
            cannot_read(where.files.front(),
                        fmt::format("it is too short for {} x {} x {} voxels, even packed; it is cut, "
                                    "or its header is damaged",
                                    header.size[0], header.size[1], header.size[2]));
        source = std::make_unique<DeflatedSource>(std::move(header), where);
    } else {
        const auto files = static_cast<std::int64_t>(where.files.size());
        const std::int64_t voxels = std::int64_t{header.size[0]} * header.size[1] * header.size[2];
        if (header.size[2] % files != 0)
            cannot_read(where.files.front(),
                        fmt::format("{} slices cannot lie in {} files of equal length", header.size[2], files));
        const std::int64_t wanted = where.offset + voxels / files * static_cast<std::int64_t>(bytes_of(header.type));
        for (const auto& path : where.files) {
            const std::int64_t found = file_bytes(path);
            if (found < wanted || (found > wanted && !where.may_be_longer))
                cannot_read(
                    path,
                    fmt::format("it has {} bytes, but {} x {} x {} voxels of {} take {}{}; {}", found, header.size[0],
                                header.size[1], header.size[2] / files, name_of(header.type), wanted,
                                where.offset > 0 ? fmt::format(", {} before them included", where.offset) : "",
                                found < wanted ? "it is cut, or its size or type is another"
                                               : fmt::format("its size or type is another, or {} bytes stand "
                                                             "before the voxels (raw: --raw-offset)",
                                                             where.offset + found - wanted)));
        }
        source = std::make_unique<RawSource>(std::move(header), where);
    }
    if (swap) return std::make_unique<SwappedSource>(std::move(source));
    return source;
}

}  // namespace tomodem::formats
