#include "core/scene/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/error.hpp"

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

/// A sample brings its radii, or they are drawn.
void check_radii(const Scene& scene, const Packing& sample) {
    if (sample.radius.empty()) return;
    if (scene.radius_dispersion > 0)
        throw InvalidInput(
            fmt::format("scene '{}': radius_dispersion = {:g} but the particles of the sample have radii of their own; "
                        "remove the key, or make the brick without --dispersion",
                        scene.path.string(), scene.radius_dispersion));
}

}  // namespace

Model compile_model(const Scene& scene, const Packing& sample) {
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
    check_radii(scene, sample);
    model.radius_dispersion = scene.radius_dispersion;
    model.self_contact = scene.self_contact;
    model.healing_time = scene.healing_time;
    model.between_objects = scene.between_objects;
    if (model.between_objects && sample.object.empty())
        throw InvalidInput(
            fmt::format("scene '{}': between_objects = true in [contact] but the sample does not distinguish "
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
