#pragma once
#include <string>

#include "core/cli/cli.hpp"
#include "core/volume/regions.hpp"
#include "core/volume/volume.hpp"

namespace tomodem {

/// What every tool that reads a volume asks for: --voxel-size, --override-voxel-size, --slice-spacing, --origin, --roi,
/// --bin, --threshold, --otsu, --relabel, and --raw-size, --raw-type, --raw-byte-order and --raw-offset for raw voxels.
struct VolumeRequest {
    std::string path;            ///< see open_volume
    double voxel_size = 0.0;     ///< mm, 0: as the file says
    double slice_spacing = 0.0;  ///< mm, 0: as the file says, or as voxel_size
    bool override_voxel_size = false;
    std::string threshold, origin, relabel, roi, bin;
    std::int64_t otsu = 0;
    std::string raw_size, raw_type, raw_byte_order = "little";
    std::int64_t raw_offset = 0;
};

/// Declares the volume as the next positional argument, and its options.
cli::Usage& add_volume(cli::Usage& usage, VolumeRequest& request);

/// The same of a tool that reads grey values: without --threshold, --otsu and --relabel.
cli::Usage& add_grey_volume(cli::Usage& usage, VolumeRequest& request);

/// The options as read_label_volume takes them.
/// @throws WrongUsage if one of them cannot be understood, or does not go with another
VolumeOptions volume_options(const VolumeRequest& request);

/// Reads the volume and reports `image` and, where Otsu's method chose them, the thresholds.
/// @throws as read_image
LabelVolume read_volume(const VolumeRequest& request, const VolumeOptions& options, cli::Tool& tool);

/// "2=1,255=2" -> {2: 1, 255: 2}. @throws WrongUsage naming `flag`
std::map<std::int32_t, std::int32_t> parse_relabel(const std::string& flag, const std::string& text);

/// "1=matrix,2=inclusion" -> {1: matrix, 2: inclusion}. @throws WrongUsage naming `flag`
std::map<std::int32_t, std::string> parse_label_names(const std::string& flag, const std::string& text);

/// "temperature=t.tif,damage=d.h5:/d" -> {damage: d.h5:/d, temperature: t.tif}; names are letters, digits and _.
/// @throws WrongUsage naming `flag`
std::map<std::string, std::string> parse_properties(const std::string& flag, const std::string& text);

/// "2:500=1,501:600=2" -> {{2, 500, 1}, {501, 600, 2}}, sorted. @throws WrongUsage naming `flag`
std::vector<LabelObjects> parse_label_objects(const std::string& flag, const std::string& text);

/// "1,2" -> {1, 2}, sorted. @throws WrongUsage naming `flag`
std::vector<std::int32_t> parse_labels(const std::string& flag, const std::string& text);

/// "6" -> faces, "18" -> edges, "26" -> corners: the choices of --connectivity.
Connectivity connectivity_of(const std::string& neighbours);

/// "x0:x1,y0:y1,z0:z1", x1 not included; {first voxel, number of voxels}. @throws WrongUsage naming `flag`
std::array<VoxelIndex, 2> parse_roi(const std::string& flag, const std::string& text);

/// "60,180" -> {60, 180}. @throws WrongUsage naming `flag`, with what is expected
std::vector<double> parse_numbers(const std::string& flag, const std::string& text, const std::string& expected);

/// "83,140" -> {83, 140}, which must rise. @throws WrongUsage naming `flag`
std::vector<double> parse_thresholds(const std::string& flag, const std::string& text);

/// "60" or "60x60x80": whole numbers of at least 1. @throws WrongUsage naming `flag`
VoxelIndex parse_size(const std::string& flag, const std::string& text);

}  // namespace tomodem
