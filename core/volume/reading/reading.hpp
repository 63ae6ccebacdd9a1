#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/volume/volume_source.hpp"

/// What the sources of the formats share: raw voxels, headers of text, numbered slices, libraries that fail on damaged
/// files. Everything throws InvalidInput with one line. Internal to core/volume.
namespace tomodem::formats {

namespace fs = std::filesystem;
using Source = std::unique_ptr<VolumeSource>;

/// Where raw voxels are. Several files follow one another, each with whole slices.
struct RawVoxels {
    std::vector<fs::path> files;
    std::int64_t offset = 0;  ///< of the first voxel in each file [bytes]
    bool big_endian = false;
    bool deflated = false;       ///< zlib or gzip, one stream in one file
    bool may_be_longer = false;  ///< something else may follow
};
/// @throws InvalidInput if the files are not as long as the header says
Source open_raw(VolumeHeader header, RawVoxels where);

/// Reads through a process of its own: on a damaged file some libraries run over their memory instead of saying so, and
/// that becomes one line as well.
/// @param library  to be named in that line
Source in_own_process(const fs::path& path, const char* library, const std::function<Source()>& open_source);

/// Puts the numbered files of one series in order.
/// @throws InvalidInput if the names differ by more than one number, a number is missing or there twice
std::vector<fs::path> in_order_of_numbers(std::vector<fs::path> files, const std::string& name);

[[noreturn]] void cannot_read(const fs::path& path, const std::string& why);

/// Refuses sizes that only damage explains, before memory is asked for.
void check_size(const fs::path& path, const std::array<std::int64_t, 3>& size);

/// First bytes of a file, at most `count`. @throws InvalidInput if it cannot be opened
std::string first_bytes(const fs::path& path, std::size_t count);

/// Length of a file [bytes]. @throws InvalidInput if it is not there
std::int64_t file_bytes(const fs::path& path);

std::string lower_case(std::string text);
std::string trimmed(const std::string& text);
std::vector<std::string> words_of(const std::string& text);

/// @throws InvalidInput naming the file and the field if it is not a number
double number_in(const fs::path& path, const std::string& field, const std::string& text);
std::int64_t whole_number_in(const fs::path& path, const std::string& field, const std::string& text);

/// Length of a unit in mm ("um", "micron", "mm", "cm", "nm", "m", "inch" ...); empty if it is none.
std::optional<double> length_unit(const std::string& name);

}  // namespace tomodem::formats
