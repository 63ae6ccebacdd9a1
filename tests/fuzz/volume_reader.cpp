// libFuzzer target: one file of a volume format, of any content, is read or refused by InvalidInput.
//
// The environment's TOMODEM_FUZZ_FILE is the name of the file that the bytes are written to ("a.nrrd"); its extension
// chooses the format. "list" prints a name for each extension of the registered formats.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/base/error.hpp"
#include "core/volume/volume_files.hpp"
#include "core/volume/volume_format.hpp"
#include "core/volume/volume_source.hpp"

namespace fs = std::filesystem;

namespace {

/// A folder of this process with the file beside which a header lies.
const fs::path& folder() {
    static const fs::path made = [] {
        const char* base = fs::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
        const fs::path name = fs::path(base) / ("tomodem-fuzz-" + std::to_string(getpid()));
        fs::create_directory(name);
        std::ofstream(name / "a.raw") << std::string(24, '\1');
        std::ofstream(name / "data") << std::string(24, '\1');
        std::atexit([] { fs::remove_all(folder()); });
        return name;
    }();
    return made;
}

std::string file_name() {
    const char* const name = std::getenv("TOMODEM_FUZZ_FILE");
    return name ? name : "a";
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    if (file_name() != "list") return 0;
    for (const tomodem::VolumeFormat& format : tomodem::volume_formats())
        for (const std::string& extension : format.extensions) std::printf("a%s\n", extension.c_str());
    std::fflush(stdout);
    _exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fs::path file = folder() / file_name();
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    tomodem::volume_files(file);
    try {
        const auto source = tomodem::open_volume(file);
        const tomodem::VolumeHeader& header = source->header();
        const std::int64_t page = std::int64_t{header.size[0]} * header.size[1];
        if (page > 1 << 22) return 0;  // memory that a real slice may ask for
        std::vector<std::byte> voxels(static_cast<std::size_t>(page) * tomodem::bytes_of(header.type));
        for (const std::int32_t k : {0, header.size[2] / 2, header.size[2] - 1})
            source->read(k, 1, {0, 0, header.size[0], header.size[1]}, voxels.data());
    } catch (const tomodem::InvalidInput&) {
    }
    return 0;
}
