#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/volume/volume_source.hpp"

namespace tomodem {

/// A segmented tomography: one integer label a voxel, 0 is void. Sparse in memory (OpenVDB), a byte a voxel
/// where labels are below 256.
///
/// Voxel (i, j, k) covers origin + spacing * (i..i+1, j..j+1, k..k+1); its centre is at +1/2.
class LabelVolume {
 public:
    /// All void.
    LabelVolume(VoxelIndex size, Vec3 spacing, Vec3 origin = Vec3::Zero());
    ~LabelVolume();
    LabelVolume(LabelVolume&&) noexcept;
    LabelVolume& operator=(LabelVolume&&) noexcept;

    VoxelIndex size() const;
    Vec3 spacing() const;  ///< mm
    Vec3 origin() const;   ///< world coordinates [mm] of the corner of voxel (0, 0, 0)
    Vec3 extent() const;   ///< size * spacing [mm]

    /// Threads that the members of this volume may use, and what is made from it; 1 at first.
    void use_threads(int threads);
    int threads() const;

    /// Copies one slice z = k, given row by row (size[0] * size[1] labels).
    void set_slice(std::int32_t k, const std::vector<std::int32_t>& labels);
    void slice(std::int32_t k, std::vector<std::int32_t>& labels) const;

    /// Copies the `count` slices from k on, slice after slice. Fastest, and leanest in memory, with k and count
    /// multiples of `slab` (or up to the last slice): blocks of one label are then never stored voxel by voxel.
    static constexpr std::int32_t slab = 8;
    void set_slices(std::int32_t k, std::int32_t count, std::span<const std::int32_t> labels);
    void slices(std::int32_t k, std::int32_t count, std::vector<std::int32_t>& labels) const;

    /// Voxels of each label that occurs.
    std::map<std::int32_t, std::int64_t> histogram() const;

    /// Bytes that the labels take in memory.
    std::int64_t memory() const;

    /// Fast repeated look-ups; one a thread. Voxels outside the volume are void.
    class Sampler {
     public:
        explicit Sampler(const LabelVolume& volume);
        ~Sampler();
        std::int32_t at(const VoxelIndex& voxel) const;
        /// Label of the voxel that contains a point [mm].
        std::int32_t nearest(const Vec3& point) const;
        /// Label that fills most of the box of half-edge `half` [mm] around `point` (ties: the smallest label). Voxels
        /// count by the part of them within the box (to 1/1024 of a voxel an axis); what sticks out of the volume
        /// does not vote, so that its faces are not eaten away.
        std::int32_t majority(const Vec3& point, double half) const;
        /// Label whose smoothed indicator is the largest at `point` (ties: the smallest label): the interfaces are
        /// level sets, smooth where those of the voxels are stairs.
        ///
        /// The smoothing has the width `width` [voxels, along each axis] and a kernel without second moment,
        /// (3/2 - u^2/2) exp(-u^2/2) along each axis with u = distance / width: a Gaussian would move a curved
        /// interface by width^2 / R and shrink all that is round. What is too thin for the level set to hold the centre
        /// of its own voxel (a wire, a speck) keeps that whole voxel: nothing thin is lost. What sticks out of the
        /// volume does not count, as in majority().
        /// @param width  0.2 to 8; cost grows as its cube where labels meet
        std::int32_t level_set(const Vec3& point, double width) const;

     private:
        struct State;
        std::unique_ptr<State> state_;
    };

 private:
    struct State;
    std::unique_ptr<State> state_;
};

/// What read_label_volume needs beyond the file itself.
struct VolumeOptions {
    /// Edges of a voxel [mm]; 0: as the file says. A z of 0 without anything in the file is that of x.
    Vec3 voxel_size = Vec3::Zero();
    bool override_voxel_size = false;              ///< the voxel size given holds even if the file says another
    std::optional<Vec3> origin;                    ///< mm; as the file says, or 0, by default
    std::optional<RawLayout> raw;                  ///< the file is raw voxels
    std::vector<double> thresholds;                ///< rising; a grey value above n of them becomes label n
    int otsu_levels = 0;                           ///< that many thresholds are found by Otsu's method
    std::map<std::int32_t, std::int32_t> relabel;  ///< applied to labels read; labels that are not named stay
    /// first voxel and number of voxels to keep, {0,0,0} x everything by default
    std::optional<std::array<VoxelIndex, 2>> region;
    /// Voxels along x, y, z that become one: grey values by their mean, labels by what most of them have (ties: the
    /// smallest). Voxels that do not fill a block at the far faces are left out.
    VoxelIndex bin{1, 1, 1};
};

/// A volume as it was read.
struct LabelledImage {
    LabelVolume volume;
    std::string description;              ///< one line: size, type and format of the file, size of the voxels
    std::vector<double> otsu_thresholds;  ///< where Otsu's method was asked for
};

/// Reads a segmented or grey volume of any format of docs/volumes.md.
///
/// Values are taken as they are stored: palette images give their indices, never colours. Floats need thresholds; NaN
/// is below them (there is a warning). The region is cut out first, then blocks are binned, thresholds applied, labels
/// renamed. A region keeps the world coordinates of its voxels: the origin moves to its first voxel.
///
/// @param spec      see open_volume
/// @param threads   also those that the volume's own members use later
/// @param reporter  progress, and how many values were not a number
/// @throws InvalidInput: not there, of no known format, cut, slices of different size or type, a gap in the numbers, no
///         voxel size or another than the file's (by more than 1 in 1000) without override_voxel_size
/// @note   memory: the labels, and one slab of slices
LabelledImage read_image(const std::string& spec, const VolumeOptions& options, int threads, Reporter& reporter);

/// The volume alone, on one thread.
LabelVolume read_label_volume(const std::string& spec, const VolumeOptions& options);

/// Values of another volume of the same size at points: those of the voxels that contain them.
/// @param image    the volume whose voxels they must be: its size is compared
/// @param points   world coordinates [mm]
/// @throws InvalidInput as read_label_volume, if the sizes differ, or a point lies outside
std::vector<double> read_values_at(const std::string& spec, const std::string& image, const VolumeOptions& options,
                                   std::span<const Vec3> points, int threads = 1,
                                   Reporter& reporter = silent_reporter());

/// Writes a multipage TIFF (atomically), LZW, with the fewest of 8, 16 or 32 bits that hold the labels; BigTIFF where
/// it could pass 4 GiB. Its description holds the spacing and the origin.
void write_label_volume(const LabelVolume& volume, const std::filesystem::path& path,
                        Reporter& reporter = silent_reporter());

/// What makes two neighbouring voxels belong together.
enum class Joining {
    any_label,   ///< both have one of the labels looked at
    same_label,  ///< both have the same label
};

/// Which voxels around one are its neighbours.
enum class Connectivity {
    faces,    ///< the 6 that share a face with it
    edges,    ///< the 18 that share a face or an edge
    corners,  ///< the 26 that share a face, an edge or a corner
};

/// Connected components of the voxels of some labels.
struct Components {
    LabelVolume number;                ///< of the component, from 1 in raster order of their first voxels; 0 elsewhere
    std::vector<std::int64_t> voxels;  ///< of each component (index 0: component 1)
    std::vector<std::int32_t> label;   ///< of the first voxel of each component
};

/// @note time linear in the voxels; beside the result two slabs and 8 bytes for each run of equal voxels along x
Components connected_components(const LabelVolume& volume, const std::vector<std::int32_t>& labels,
                                Joining joining = Joining::any_label, Connectivity connectivity = Connectivity::faces,
                                Reporter& reporter = silent_reporter());

/// Gives each component of `labels` (same_label, by these neighbours) with fewer than `min_voxels` voxels the label
/// that most of its outer face neighbours have (ties: the smallest), as they were before. @return number of components
/// that were changed
std::int64_t remove_small_components(LabelVolume& volume, const std::vector<std::int32_t>& labels,
                                     std::int64_t min_voxels, Connectivity by = Connectivity::faces,
                                     Reporter& reporter = silent_reporter());

}  // namespace tomodem
