#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/volume/volume_source.hpp"

namespace tomodem {

/// A part of a volume, slab by slab, with blocks of voxels replaced by their mean.
class GreySlabs {
 public:
    /// @param region  first voxel and number of voxels, within the volume
    /// @param bin     voxels of a block along x, y, z, at most those of the region; {1,1,1}: as stored
    GreySlabs(VolumeSource& source, const std::array<VoxelIndex, 2>& region, const VoxelIndex& bin, int threads = 1);

    /// Blocks that fit; what is left over at the far faces is left out.
    VoxelIndex size() const { return size_; }
    /// Of what read() gives: the file's, or float64 where there are means.
    VoxelType type() const { return binned_ ? VoxelType::float64 : source_.header().type; }
    /// Slices k .. k + count - 1 of size(), one after another, as values of type().
    void read(std::int32_t k, std::int32_t count, std::vector<std::byte>& voxels);

 private:
    VolumeSource& source_;
    std::array<VoxelIndex, 2> region_;
    VoxelIndex bin_, size_;
    bool binned_;
    int threads_;
    std::vector<std::byte> block_;
};

/// How often each grey value occurs.
struct GreyHistogram {
    double low = 0;     ///< smallest value of the first bin
    double width = 1;   ///< of a bin
    bool whole = true;  ///< every bin holds one whole number, which is low + its index
    std::vector<std::int64_t> counts;
    std::int64_t not_a_number = 0;

    std::int64_t voxels() const;
    /// The largest value that falls into a bin: values above it fall into later ones.
    double upper(std::size_t bin) const {
        return whole ? low + static_cast<double>(bin) : low + width * (static_cast<double>(bin) + 1);
    }
};

/// Integers of 8 and 16 bits, and other whole numbers of that range, are counted one by one, others in 4096 bins from
/// the smallest to the largest.
/// @throws InvalidInput if there is no number in it
/// @note   passes over the file once, or twice for other values
GreyHistogram count_grey_values(GreySlabs& slabs, int threads = 1, Reporter& reporter = silent_reporter());

struct VolumeOptions;

/// The grey values of the part of a file that the options keep: region and bin count, thresholds do not.
struct GreyImage {
    GreyHistogram histogram;
    std::string description;  ///< one line: size, type and format of the file
};
GreyImage read_grey_histogram(const std::string& spec, const VolumeOptions& options, int threads = 1,
                              Reporter& reporter = silent_reporter());

/// Otsu's thresholds (IEEE Trans. SMC 9 (1979) 62): the classes that they cut have the largest variance between them.
/// A value belongs to the class of the number of thresholds that it is above.
/// @param levels  1 or 2
/// @throws InvalidInput if the image has too few grey values
std::vector<double> otsu_thresholds(const GreyHistogram& histogram, int levels);

}  // namespace tomodem
