#pragma once
#include <filesystem>
#include <optional>

#include "tools/packgen/compaction.hpp"

namespace tomodem::packgen {

/// Changes whenever the same Compaction gives other particles: bricks kept before are not used then.
inline constexpr int algorithm_version = 1;

/// Bricks that were made once, kept in a folder, one file each. The name of a file is the SHA-256 of a text of
/// everything that determines the particles; the file holds that text, and the SHA-256 of the particles.
class BrickCache {
 public:
    /// An empty path: keeps and finds nothing.
    explicit BrickCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// $XDG_CACHE_HOME/tomodem/packgen, ~/.cache/tomodem/packgen where that is not set or not absolute; empty without
    /// both.
    static std::filesystem::path users_folder();

    /// Nothing if the brick is not there, is damaged, or cannot be read. Never throws.
    std::optional<CompactedPacking> find(const Compaction& wanted) const;

    /// Keeps a brick, whole or not at all, also when several processes do so at once.
    /// @return whether it is kept; a folder that cannot be written is no error
    bool keep(const Compaction& wanted, const CompactedPacking& made) const;

    /// Where the brick of these options is kept.
    std::filesystem::path path_of(const Compaction& wanted) const;

 private:
    std::filesystem::path folder_;
};

}  // namespace tomodem::packgen
