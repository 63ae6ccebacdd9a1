#include "core/scene/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "core/base/error.hpp"
#include "core/scene/unusual_values.hpp"

namespace tomodem {
namespace {

/// A table of one's own need not hold every law; constants that are given need none.
void require_calibration(const Scene& scene) {
    const Calibration& table = scene.flow_table();
    const auto phase = std::find_if(scene.phases.begin(), scene.phases.end(), [](auto& one) { return one.norton; });
    if (phase == scene.phases.end()) return;
    const std::string& law = scene.law().name();
    if (!table.tables.contains(law))
        throw InvalidInput(
            fmt::format("scene '{}' line {}: [phase.{}] has law \"{}\", which the calibration '{}' does not hold; make "
                        "it with pipelines/calibrate LAWS={}, or remove calibration from [accuracy]",
                        scene.path.string(), phase->line, phase->name, law, table.name, law));
}

void check_lateral_sides(const Scene& scene, const Packing& sample) {
    const auto refuse = [&](const std::string& what) {
        throw InvalidInput(fmt::format("scene '{}' line {}: periodic sides in [load]: {}", scene.path.string(),
                                       scene.load_line, what));
    };
    // A particle must not meet another and its image at once.
    const double least = 4 * scene.crown_radius * sample.seed_radius / scene.seed_radius;
    for (int axis : {(scene.axis + 1) % 3, (scene.axis + 2) % 3}) {
        const char name = "xyz"[axis];
        if (!sample.box.periodic[axis])
            refuse(
                fmt::format("the sample's box is not periodic along {}; take a brick from packgen, relaxed with this "
                            "scene if at all",
                            name));
        if (sample.box.edges[axis] < least)
            refuse(fmt::format("the sample's box is {:g} mm along {}: it needs four crown radii, {:g} mm",
                               sample.box.edges[axis], name, least));
        const auto [low, high] = std::minmax_element(sample.position.begin(), sample.position.end(),
                                                     [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
        if ((*high)[axis] - (*low)[axis] < sample.box.edges[axis] - 4 * sample.seed_radius)
            refuse(fmt::format("the sample does not fill its box along {}: it would not touch its own image", name));
    }
}

bool same_name(const std::string& one, const std::string& other) {
    return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

/// A sample brings its radii, or they are drawn.
void check_radii(const Scene& scene, const Packing& sample) {
    if (sample.radius.empty()) return;
    if (scene.radius_dispersion > 0)
        throw InvalidInput(
            fmt::format("scene '{}': radius_dispersion = {:g} but the particles of the sample have radii of their own; "
                        "remove the key, or make the brick without --dispersion",
                        scene.path.string(), scene.radius_dispersion));
}

/// Distance of the outermost centres along the loading axis.
double height_of(const Scene& scene, const Packing& sample) {
    const auto [low, high] = std::minmax_element(sample.position.begin(), sample.position.end(),
                                                 [&](auto& a, auto& b) { return a[scene.axis] < b[scene.axis]; });
    return sample.position.empty() ? 0 : (*high)[scene.axis] - (*low)[scene.axis];
}

}  // namespace

void check_names(const Scene& scene, const Packing& sample) {
    for (const Phase& phase : scene.phases)
        for (const auto& [label, name] : sample.label_names)
            if (label != phase.label && same_name(name, phase.name))
                throw InvalidInput(fmt::format(
                    "scene '{}' line {}: [phase.{}] has label {}, but in the sample (vol2pack --labels) label {} is "
                    "'{}'; write label = {} there, or give other names to vol2pack --labels",
                    scene.path.string(), phase.line, phase.name, phase.label, label, name, label));
}

std::vector<std::string> other_names(const Scene& scene, const Packing& sample) {
    std::vector<std::string> found;
    for (const Phase& phase : scene.phases)
        if (const auto name = sample.label_names.find(phase.label);
            name != sample.label_names.end() && !same_name(name->second, phase.name))
            found.push_back(
                fmt::format("label {} is '{}' in the sample and [phase.{}] in the scene: are they the same?",
                            phase.label, name->second, phase.name));
    return found;
}

Model compile_model(const Scene& scene, const Packing& sample, std::optional<double> height) {
    check_names(scene, sample);
    refuse_unusual_size(scene, sample);
    const std::set<std::int32_t> present(sample.species.begin(), sample.species.end());
    for (const Phase& phase : scene.phases) {
        if (!present.contains(phase.label))
            throw InvalidInput(
                fmt::format("scene '{}' line {}: [phase.{}] has no particle: the sample has none of label {}",
                            scene.path.string(), phase.line, phase.name, phase.label));
        if (phase.objects && sample.object.empty())
            throw InvalidInput(fmt::format(
                "scene '{}' line {}: [phase.{}] has objects = true but the sample does not distinguish objects; "
                "make it with vol2pack --objects {}",
                scene.path.string(), phase.line, phase.name, phase.label));
    }
    require_calibration(scene);
    Model model;
    model.seed_radius = scene.seed_radius;
    model.crown_radius = scene.crown_radius;
    model.law = &scene.law();
    model.height = height.value_or(height_of(scene, sample) / (2 * sample.seed_radius));
    check_radii(scene, sample);
    model.radius_dispersion = scene.radius_dispersion;
    model.self_contact = scene.self_contact;
    model.healing_time = scene.healing_time;
    model.objects_only_push = scene.objects_only_push;
    if (model.objects_only_push && sample.object.empty())
        throw InvalidInput(
            fmt::format("scene '{}': objects_only_push = true in [contact] but the sample does not distinguish "
                        "objects; make it with vol2pack --objects LABEL",
                        scene.path.string()));
    model.lateral = scene.lateral;
    if (model.lateral != Lateral::free) check_lateral_sides(scene, sample);
    for (std::int32_t label : present) model.phases.push_back({label, {}, 0, 0, 0, scene.phase(label).hardening});
    scene.law().compile(scene, sample, model);
    return model;
}

std::int64_t relaxation_steps(const Model& model, double periods) {
    return static_cast<std::int64_t>(std::ceil(periods * model.law->steps_of_a_relaxation_period(model)));
}

}  // namespace tomodem
