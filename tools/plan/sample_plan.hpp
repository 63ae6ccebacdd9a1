#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/volume/volume.hpp"
#include "tools/plan/objects.hpp"

/// What the chain from an image to its report needs to know besides the image, when the size of the particles is given.
namespace tomodem::plan {

/// A label of the image that is not void.
struct SolidLabel {
    std::int32_t label = 0;
    std::int64_t voxels = 0;
    std::int64_t largest_object = 0;  ///< voxels of its largest component, connected by faces, or labelled object
};

/// The solid labels of an image, that with most voxels first.
/// @param labelled  objects of one of them that had labels of their own; nullptr: none
/// @throws InvalidInput if it has more labels than phases (16), or is all void
std::vector<SolidLabel> solid_labels(const LabelVolume& volume, const LabelledObjects* labelled = nullptr);

/// Law of a scene that is proposed.
const Law& proposed_law();

/// What the user wants of the sample.
struct SampleRequest {
    std::optional<double> particles;            ///< number of particles to aim at; or
    std::optional<double> pixels_per_seed;      ///< radius of a particle [voxels]
    double density = 0.7;                       ///< D of the brick
    std::map<std::int32_t, std::string> names;  ///< of the labels; empty: those of the scene, or made up
    ObjectsBy by = ObjectsBy::components;
    std::vector<LabelObjects> ranges{};  ///< of objects that have labels of their own
};

/// A shape is measured of objects of at least this many particles.
inline constexpr std::int64_t min_particles_of_shape = 20;

/// The scene of a run, and what the tools that show and measure it need of its load.
struct LoadPlan {
    std::string scene;  ///< text: the user's own, or the one proposed
    char axis = 'z';
    double largest_strain = 0;  ///< magnitude
};

LoadPlan load_of(const Scene& scene, const std::string& scene_text);

struct SamplePlan {
    std::map<std::int32_t, std::string> names;  ///< of the solid labels
    ObjectsBy by = ObjectsBy::components;
    std::vector<std::int32_t> objects;  ///< labels that consist of objects, rising
    std::vector<LabelObjects> ranges;   ///< of objects with labels of their own
    std::int32_t shown = 0;             ///< the label that pictures and meshes show alone
    bool inclusions = false;            ///< there is more than the matrix
    double pixels_per_seed = 0;         ///< radius of a particle [voxels]
    double seed_radius = 0;             ///< [mm]
    double particles = 0;               ///< expected number
    std::int64_t min_component = 0;     ///< smaller components are taken out of the image [voxels]; 0: none are
    double probe_radius = 0;            ///< of the surfaces [mm]
    LoadPlan load;
};

/// The matrix is the label with most voxels; the others are inclusions, which consist of objects, unless the scene
/// marks other phases with `objects = true`. Without a scene of the user, the law is NORTON, the matrix has a flow
/// stress of 100 MPa at 1e-3 /s with M = 0.1, inclusions that of the thesis' phase B (170 MPa, M = 0.49), and the
/// sample is pressed along z to a strain of -0.3.
///
/// In a porous image (solid below 98 %), components too small to have a shape are taken out: loose between the planes,
/// they would carry the first load. Probes of 1.6 particle radii wrap a surface around dense particles without holes.
///
/// @param scene  of the user; none: one is proposed
/// @throws InvalidInput if names or scene do not fit the labels of the image, if the largest object has too few
///         particles to have a shape, or if a watershed is to separate the objects of more than one phase
SamplePlan plan_sample(const LabelVolume& volume, const std::vector<SolidLabel>& solid, const SampleRequest& request,
                       const std::optional<Scene>& scene, const std::string& scene_text);

/// Options of the tools of the chain: file name -> one line of options. Those of the sample depend on the image.
std::map<std::string, std::string> sample_options(const SamplePlan& plan);
/// Those that follow from the load alone.
std::map<std::string, std::string> load_options(const LoadPlan& load);

}  // namespace tomodem::plan
