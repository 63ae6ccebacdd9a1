#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/volume/volume.hpp"
#include "tools/vol2pack/sample.hpp"

namespace tomodem::vol2pack {

/// Area of the boundary of each label [mm^2], faces of the volume left out, estimated by Buffon's needles: a needle of
/// length r at a random place and of a random direction has its ends in different labels with the probability
/// S r / (2 V) (Crofton; Ohser & Schladitz, 3D Images of Materials Structures (2009), chapter 4).
///
/// Flat interfaces are measured without bias, whatever the needles stand on; a needle that passes through a bump of the
/// interface twice is not counted, which loses the share r^2 / (12 R^2) of a sphere of radius R. Here the needles are
/// pairs of voxels, about two voxels long, in directions spread evenly over the sphere also where voxels are not
/// cubes; 2 million of them at most. A label's area is good to about 1 / sqrt(needles that cross it). Needles that
/// leave the volume end in its mirror image, so that an interface which reaches a face counts to its end.
///
/// The same needles give the thickness of a label: where one of them crosses the boundary, the length of the normal
/// that starts there and runs inwards to the next boundary. It is the thickness of a plate and the diameter of a rod or
/// a sphere. Normals are those of the indicator smoothed over two voxels. A normal that leaves the volume counts as
/// `cap`.
struct ImageGeometry {
    struct Label {
        double surface = 0.0;           ///< mm^2
        std::vector<double> thickness;  ///< mm, sorted, at places spread evenly over the boundary
        /// The thinnest feature: a twentieth of the boundary has something thinner behind it; infinite without
        /// boundary.
        double thinnest() const;
    };
    std::map<std::int32_t, Label> label;
};

/// @param cap  thicknesses beyond it count as this [mm]
/// @note  needs little memory; at most about a second of CPU time, whatever the size of the volume
ImageGeometry measure_image(const LabelVolume& volume, double cap, int threads);

/// The same surfaces of the particles: needles are pairs of neighbouring particles, those in void and in the margin
/// included.
/// @return  mm^2, of each label, void included
std::map<std::int32_t, double> particle_surfaces(const Tiling& tiling, const Places& places,
                                                 const std::vector<Tiling::Needle>& needles, int threads);

/// What becomes of the image's connected components.
struct ComponentLoss {
    std::int64_t components = 0;    ///< of the image
    std::int64_t lost = 0;          ///< hold no particle
    std::int64_t merged = 0;        ///< components with particles, less the groups that these form
    std::int64_t largest_lost = 0;  ///< voxels
};

/// Components of one label form a group where particles of theirs are neighbours: in the sample they touch.
std::map<std::int32_t, ComponentLoss> component_losses(const Tiling& tiling, const Places& places,
                                                       const std::vector<Tiling::Needle>& needles,
                                                       const Regions& regions);

/// How far a sample is from its image, label by label; void is a label as well.
struct GeometricError {
    struct Label {
        std::int32_t label = 0;
        double image_fraction = 0.0, sample_fraction = 0.0;  ///< of the volume
        double image_surface = 0.0, sample_surface = 0.0;    ///< mm^2
        double thinnest = 0.0;                               ///< in diameters of a seed; infinite: no boundary
        ComponentLoss components;
        double volume_error() const { return sample_fraction / image_fraction - 1; }
        double surface_error() const { return sample_surface / image_surface - 1; }
    };
    std::vector<Label> labels;
    bool components_counted = false;
    /// Largest relative error of the volume of a label of the image.
    double volume_error() const;
    /// As it stands in --json and in the file.
    nlohmann::ordered_json json() const;
};

/// @param regions  of all labels of the image, or nullptr: losses are not counted
GeometricError geometric_error(const LabelVolume& volume, const Tiling& tiling, const Places& places,
                               const Regions* regions, int threads);

/// Largest over the labels of an image of |volume in the sample / volume in the image - 1|.
double largest_volume_error(const std::map<std::int32_t, std::int64_t>& voxels,
                            const std::map<std::int32_t, std::int64_t>& particles);

void report_geometric_error(const GeometricError& error, Reporter& reporter);

}  // namespace tomodem::vol2pack
