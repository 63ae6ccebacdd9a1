// A volume format in one source: nothing else of the project knows it.
//
// "TOYVOL nx ny nz size_um VALUES" in a file, the voxels as numbers in the text file VALUES beside it.
#include <fstream>

#include "core/volume/reading/reading.hpp"
#include "core/volume/volume_format.hpp"

namespace tomodem::formats {
namespace {

std::vector<std::string> words_in(const fs::path& file) {
    const std::int64_t bytes = file_bytes(file);
    return words_of(first_bytes(file, static_cast<std::size_t>(bytes)));
}

fs::path values_of(const fs::path& file) {
    const std::vector<std::string> words = words_in(file);
    if (words.size() != 6 || words[0] != "TOYVOL")
        cannot_read(file, "its line is not 'TOYVOL nx ny nz size_um VALUES'");
    return file.parent_path() / words[5];
}

class ToySource : public VolumeSource {
 public:
    explicit ToySource(const fs::path& file) {
        const fs::path values = values_of(file);
        const std::vector<std::string> words = words_in(file);
        std::array<std::int64_t, 3> size;
        for (int axis = 0; axis < 3; ++axis) size[axis] = whole_number_in(file, "size", words[axis + 1]);
        check_size(file, size);
        for (int axis = 0; axis < 3; ++axis) header_.size[axis] = static_cast<std::int32_t>(size[axis]);
        header_.format = "toy";
        header_.type = VoxelType::int32;
        header_.spacing = Vec3::Constant(1e-3 * number_in(file, "size_um", words[4]));
        header_.spacing_has_unit = true;
        for (const std::string& word : words_in(values))
            voxels_.push_back(static_cast<std::int32_t>(whole_number_in(values, "a voxel", word)));
        if (static_cast<std::int64_t>(voxels_.size()) != size[0] * size[1] * size[2])
            cannot_read(values, fmt::format("it has {} values", voxels_.size()));
    }

    void read(std::int32_t k, std::int32_t count, const Window& window, std::byte* voxels) override {
        auto* to = reinterpret_cast<std::int32_t*>(voxels);
        for (std::int64_t z = k; z < k + count; ++z)
            for (std::int64_t y = window.y; y < window.y + window.height; ++y)
                for (std::int64_t x = window.x; x < window.x + window.width; ++x)
                    *to++ = voxels_[static_cast<std::size_t>((z * header_.size[1] + y) * header_.size[0] + x)];
    }

 private:
    std::vector<std::int32_t> voxels_;
};

const RegisteredFormat toy{{
    .name = "Toy text",
    .extensions = {".toy"},
    .sniff = [](const std::string& start, const fs::path&) { return start.starts_with("TOYVOL "); },
    .companions =
        [](const fs::path& file) {
            return std::vector{file, values_of(file)};
        },
    .open = [](const fs::path& file, const std::string&) -> Source { return std::make_unique<ToySource>(file); },
}};

}  // namespace
}  // namespace tomodem::formats
