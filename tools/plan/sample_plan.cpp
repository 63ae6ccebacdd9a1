#include "tools/plan/sample_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace tomodem::plan {
namespace {

/// Share of solid below which an image is porous.
constexpr double dense_fraction = 0.98;
/// Of a probe, over the radius of a particle.
constexpr double probe_ratio = 1.6;
/// Of a proposed scene.
constexpr double proposed_strain = 0.3;

constexpr const char* matrix_law = "norton = { K = 200, M = 0.1 }     # MPa.s^M";
constexpr const char* inclusion_law = "norton = { K = 5020, M = 0.49 }   # MPa.s^M";

double volume_of_ball(double radius) {
    return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
}

double radius_of_ball(double volume) {
    return std::cbrt(volume * 3 / (4 * std::numbers::pi));
}

double rounded_to_hundredths(double value) {
    return std::stod(fmt::format("{:.2f}", value));
}

std::vector<std::int32_t> labels_of(const std::vector<SolidLabel>& solid) {
    std::vector<std::int32_t> labels;
    for (const SolidLabel& one : solid) labels.push_back(one.label);
    std::sort(labels.begin(), labels.end());
    return labels;
}

void check_names(const std::map<std::int32_t, std::string>& names, const std::vector<SolidLabel>& solid) {
    if (names.empty()) return;
    const std::vector<std::int32_t> labels = labels_of(solid);
    for (const std::int32_t label : labels)
        if (!names.contains(label))
            throw InvalidInput(fmt::format("--labels does not name label {}, which the image has; it has {}", label,
                                           fmt::join(labels, ", ")));
    for (const auto& [label, name] : names) {
        if (label != 0 && !std::binary_search(labels.begin(), labels.end(), label))
            throw InvalidInput(fmt::format("--labels names label {} ({}), which the image does not have; it has {}",
                                           label, name, fmt::join(labels, ", ")));
        if (name.find_first_of("\"\\") != std::string::npos)
            throw InvalidInput(fmt::format("--labels: the name '{}' holds a quote or a backslash", name));
    }
}

std::map<std::int32_t, std::string> names_in(const Scene& scene, const std::vector<SolidLabel>& solid) {
    std::map<std::int32_t, std::string> names;
    for (const SolidLabel& one : solid) {
        const auto phase = std::find_if(scene.phases.begin(), scene.phases.end(),
                                        [&](const Phase& known) { return known.label == one.label; });
        if (phase == scene.phases.end())
            throw InvalidInput(
                fmt::format("scene '{}' has no phase with label {}, which the image has; add one, or remove the label "
                            "with --relabel {}=0",
                            scene.path.string(), one.label, one.label));
        names[one.label] = phase->name;
    }
    return names;
}

std::map<std::int32_t, std::string> made_names(const std::vector<SolidLabel>& solid) {
    std::map<std::int32_t, std::string> names;
    for (std::size_t k = 0; k < solid.size(); ++k)
        names[solid[k].label] = k == 0              ? (solid.size() > 1 ? "matrix" : "solid")
                                : solid.size() == 2 ? "inclusion"
                                                    : fmt::format("inclusion{}", solid[k].label);
    return names;
}

std::string proposed_scene(const std::map<std::int32_t, std::string>& names, const std::vector<SolidLabel>& solid) {
    std::string text =
        "# Made from the labels of the image; for another material, edit a copy and give it as --scene (pipelines: "
        "SCENE=)\n"
        "seed_radius = 0.5   # mm; the constants are scaled to the particles of the sample\n\n";
    for (std::size_t k = 0; k < solid.size(); ++k)
        text +=
            fmt::format("[phase.\"{}\"]\nlabel = {}\nlaw = \"{}\"\n{}\n{}\n", names.at(solid[k].label), solid[k].label,
                        proposed_law().name(), k == 0 ? matrix_law : inclusion_law, k == 0 ? "" : "objects = true\n");
    return text + fmt::format(
                      "[load]\naxis = \"z\"\nsteps = [ {{ strain = -{:g}, rate = 1e-3 }} ]\n\n"
                      "[accuracy]\nframes = 30\n",
                      proposed_strain);
}

}  // namespace

const Law& proposed_law() {
    return norton_law();
}

std::vector<SolidLabel> solid_labels(const LabelVolume& volume, const LabelledObjects* labelled) {
    const std::map<std::int32_t, std::int64_t> histogram = volume.histogram();
    if (histogram.size() > most_phases)
        throw InvalidInput(
            fmt::format("the image has {} different values: if it is grey, give --threshold or --otsu; if each value "
                        "is an object, --objects labels",
                        histogram.size()));
    std::vector<SolidLabel> solid;
    std::vector<std::int32_t> labels;
    for (const auto& [label, voxels] : histogram) {
        if (label == 0) continue;
        solid.push_back({label, voxels});
        labels.push_back(label);
    }
    if (solid.empty())
        throw InvalidInput("the image is all void (label 0); give another --threshold, or other labels with --relabel");
    const Components components = connected_components(volume, labels, Joining::same_label);
    for (SolidLabel& one : solid) {
        if (labelled != nullptr && one.label == labelled->phase) {
            one.largest_object = *std::max_element(labelled->voxels.begin(), labelled->voxels.end());
            continue;
        }
        for (std::size_t k = 0; k < components.voxels.size(); ++k)
            if (one.label == components.label[k])
                one.largest_object = std::max(one.largest_object, components.voxels[k]);
    }
    std::stable_sort(solid.begin(), solid.end(),
                     [](const SolidLabel& a, const SolidLabel& b) { return a.voxels > b.voxels; });
    return solid;
}

LoadPlan load_of(const Scene& scene, const std::string& scene_text) {
    LoadPlan load{scene_text, "xyz"[scene.axis], 0};
    for (const LoadStep& step : scene.steps) load.largest_strain = std::max(load.largest_strain, std::abs(step.strain));
    if (scene.steps.empty()) load.largest_strain = scene.path_length();
    return load;
}

SamplePlan plan_sample(const LabelVolume& volume, const std::vector<SolidLabel>& solid, const SampleRequest& request,
                       const std::optional<Scene>& scene, const std::string& scene_text) {
    SamplePlan plan;
    check_names(request.names, solid);
    if (scene) {
        plan.names = names_in(*scene, solid);
        plan.load = load_of(*scene, scene_text);
    } else {
        plan.names = made_names(solid);
    }
    for (auto& [label, name] : plan.names)
        if (const auto given = request.names.find(label); given != request.names.end()) name = given->second;
    if (!scene) plan.load = {proposed_scene(plan.names, solid), 'z', proposed_strain};

    // In voxels of the size along x, that a radius is given in.
    const double voxel = volume.spacing()[0];
    const VoxelIndex size = volume.size();
    std::int64_t solid_voxels = 0;
    for (const SolidLabel& one : solid) solid_voxels += one.voxels;
    const double share =
        static_cast<double>(solid_voxels) / (static_cast<double>(size[0]) * size[1] * static_cast<double>(size[2]));
    const double filled = share * (volume.extent() / voxel).prod();
    plan.pixels_per_seed =
        request.pixels_per_seed
            ? *request.pixels_per_seed
            : std::max(0.01,
                       rounded_to_hundredths(radius_of_ball(filled * request.density / request.particles.value())));
    plan.seed_radius = plan.pixels_per_seed * voxel;
    plan.probe_radius = probe_ratio * plan.seed_radius;
    const double voxels_of_particle = volume_of_ball(plan.pixels_per_seed) / request.density;
    plan.particles = filled / voxels_of_particle;

    plan.inclusions = solid.size() > 1;
    const bool marked = scene && std::any_of(scene->phases.begin(), scene->phases.end(),
                                             [](const Phase& phase) { return phase.objects; });
    const auto has_objects = [&](const SolidLabel& one) {
        return marked ? scene->phase(one.label).objects : !plan.inclusions || one.label != solid.front().label;
    };
    std::int64_t largest = 0;
    for (const SolidLabel& one : solid) {
        if (!has_objects(one)) continue;
        if (plan.objects.empty()) plan.shown = one.label;
        plan.objects.push_back(one.label);
        largest = std::max(largest, one.largest_object);
    }
    if (plan.objects.empty())
        throw InvalidInput(
            fmt::format("scene '{}' marks objects of phases that the image does not have", scene->path.string()));
    std::sort(plan.objects.begin(), plan.objects.end());
    plan.by = request.by;
    plan.ranges = request.ranges;
    if (plan.by == ObjectsBy::watershed) {
        if (plan.objects.size() > 1)
            throw InvalidInput(fmt::format(
                "--objects watershed separates the objects of one label, and {} consist of objects; give a --scene "
                "with objects = true at one phase",
                fmt::join(plan.objects, ", ")));
        plan.ranges = {separated_range(labels_of(solid), plan.objects.front())};
    }
    if (static_cast<double>(largest) < min_particles_of_shape * voxels_of_particle) {
        const double needed = radius_of_ball(static_cast<double>(largest) / min_particles_of_shape * request.density);
        throw InvalidInput(fmt::format(
            "the largest {} would have {:.0f} particles, too few to have a shape; give --pixels-per-seed {:g} or less "
            "(now {:g}), or more --particles",
            plan.inclusions ? "inclusion" : "part", static_cast<double>(largest) / voxels_of_particle,
            std::floor(needed * 50) / 100, plan.pixels_per_seed));
    }
    // An object with a label of its own is a component too, and none is taken out for being small.
    const bool porous = share < dense_fraction;
    if (plan.by == ObjectsBy::components)
        plan.min_component = static_cast<std::int64_t>(
            std::ceil(voxels_of_particle * static_cast<double>(porous ? min_particles_of_shape : 1)));
    return plan;
}

std::map<std::string, std::string> sample_options(const SamplePlan& plan) {
    std::vector<std::string> names;
    for (const auto& [label, name] : plan.names) names.push_back(fmt::format("{}={}", label, name));
    const std::string labels = fmt::format("--labels {}", fmt::join(names, ","));
    std::map<std::string, std::string> options{
        {"vol2pack", fmt::format("--pixels-per-seed {:g} {} {}{}", plan.pixels_per_seed, labels,
                                 vol2pack_options(plan.by, plan.objects, plan.ranges),
                                 plan.min_component > 0 ? fmt::format(" --min-component {}", plan.min_component) : "")},
        {"render", labels},
        {"inclusions", fmt::format("--only-species {} --color {}", plan.shown, plan.inclusions ? "object" : "phase")},
        {"mesh_recon", fmt::format("--species {} --probe-radius {:.6g}mm", plan.shown, plan.probe_radius)},
        {"shape_factor", fmt::format("--min-particles {}", min_particles_of_shape)},
    };
    if (plan.by == ObjectsBy::watershed)
        options["separate_objects"] = fmt::format("--labels {}", plan.ranges.front().species);
    return options;
}

std::map<std::string, std::string> load_options(const LoadPlan& load) {
    return {
        {"press", fmt::format("--press {}", load.axis)},
        {"equilibrium", fmt::format("--from {:g}", 2.0 / 3 * load.largest_strain)},
    };
}

}  // namespace tomodem::plan
