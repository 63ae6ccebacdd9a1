#pragma once
#include <filesystem>
#include <string_view>

namespace tomodem {

/// A file that appears complete or not at all: written beside its final place, renamed by commit().
///
/// The destructor removes what was not committed, so the previous file of that name stays untouched on any error;
/// so do SIGINT, SIGTERM and SIGHUP before they end the process.
class OutputFile {
 public:
    /// @throws InvalidInput if the folder does not exist or cannot be written to
    explicit OutputFile(std::filesystem::path final_path);
    /// The same, written at `part`, which is what a later process looks for (see keep()).
    OutputFile(std::filesystem::path final_path, std::filesystem::path part);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where to write: ".NAME.part-PID" in the folder of the final path, the extension kept.
    const std::filesystem::path& path() const { return part_; }
    /// From now on the unfinished file outlives this process: another one can resume it.
    void keep();
    /// Flushes to disk what was written so far. @throws InvalidInput if that fails (disk full)
    void flush();
    /// Flushes to disk and renames. @throws InvalidInput if either fails (disk full)
    void commit();

 private:
    std::filesystem::path final_, part_;
    void check();
    bool committed_ = false, kept_ = false;
};

/// Writes a small text file in one go (atomically). @throws InvalidInput if it cannot be written
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace tomodem
