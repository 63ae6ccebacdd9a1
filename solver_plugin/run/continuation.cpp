#include "solver_plugin/run/continuation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "core/base/error.hpp"
#include "core/packing/packing_file.hpp"

namespace tomodem {
namespace {

const char* name_of(Lateral sides) {
    return sides == Lateral::free ? "free" : sides == Lateral::periodic ? "periodic" : "isochoric";
}

std::set<std::int32_t> labels_of(const Scene& scene) {
    std::set<std::int32_t> labels;
    for (const Phase& phase : scene.phases) labels.insert(phase.label);
    return labels;
}

/// The box of the undeformed sample after the strain of the run.
Box deformed(Box box, const Scene& scene, const EndOfRun& end, double strain) {
    const int across[] = {(scene.axis + 1) % 3, (scene.axis + 2) % 3};
    const double widening = std::sqrt(end.section / (box.edges[across[0]] * box.edges[across[1]]));
    const Vec3 middle = box.origin + box.edges / 2;
    for (const int axis : across) {
        box.edges[axis] *= widening;
        box.periodic[axis] = scene.lateral != Lateral::free;
    }
    box.edges[scene.axis] *= std::exp(strain);
    box.origin = middle - box.edges / 2;
    return box;
}

}  // namespace

void EndOfRun::save(Checkpoint& checkpoint) const {
    checkpoint.numbers["end"] = {strain, total_strain, rate,           time_step,
                                 height, section,      kinetic_energy, potential_energy};
    checkpoint.numbers["window"] = window;
}

EndOfRun EndOfRun::restored(const Checkpoint& checkpoint) {
    const std::vector<double>& numbers = checkpoint.numbers.at("end");
    return {.strain = numbers.at(0),
            .total_strain = numbers.at(1),
            .rate = numbers.at(2),
            .time_step = numbers.at(3),
            .height = numbers.at(4),
            .section = numbers.at(5),
            .kinetic_energy = numbers.at(6),
            .potential_energy = numbers.at(7),
            .window = checkpoint.numbers.at("window")};
}

double Continuation::time() const {
    const Checkpoint& at = state.checkpoint;
    return clock_of(at.numbers.at("solver_material_clock")).at(static_cast<std::int64_t>(at.number("solver_step")));
}

LoadBegin Continuation::begin(const Scene& next) const {
    if (!has_planes() || next.steps.empty()) return {};
    return {.strain = end.strain, .rate = end.rate};
}

Continuation read_continuation(const std::filesystem::path& run, MPI_Comm communicator) {
    const RunReader reader(run);
    if (reader.frame_count() < 2)
        throw InvalidInput(
            fmt::format("cannot continue from '{}': it is a sample, not a run; leave --frame out", run.string()));
    Continuation found{.run = run,
                       .last_frame = reader.frame_count() - 1,
                       .scene = parse_stored_scene(reader.provenance().scene, "of " + run.string()),
                       .sample = reader.packing(),
                       .state = read_end_state(run, communicator),
                       .end = {}};
    found.end = EndOfRun::restored(found.state.checkpoint);
    found.sample.position = reader.frame(found.last_frame).position;
    const double strain = found.end.total_strain - reader.provenance().strain_before.value_or(0);
    found.sample.box = deformed(found.sample.box, found.scene, found.end, strain);
    return found;
}

void check_continuation(const Continuation& before, const Scene& next) {
    const Scene& last = before.scene;
    const auto require_same = [&](const std::string& what, const auto& its, const auto& mine) {
        if (its != mine)
            throw InvalidInput(fmt::format(
                "scene '{}' has {} {}, but the run '{}' had {}: a load continues from its end with the same",
                next.path.string(), what, mine, before.run.string(), its));
    };
    require_same("law", last.law().name(), next.law().name());
    require_same("seed_radius", last.seed_radius, next.seed_radius);
    require_same("crown_radius", last.crown_radius, next.crown_radius);
    require_same("radius_dispersion", last.radius_dispersion, next.radius_dispersion);
    require_same("objects_only_push", last.objects_only_push, next.objects_only_push);
    require_same("axis", "xyz"[last.axis], "xyz"[next.axis]);
    require_same("lateral", std::string(name_of(last.lateral)), std::string(name_of(next.lateral)));
    if (labels_of(last) != labels_of(next))
        throw InvalidInput(
            fmt::format("scene '{}' has phases of other labels than the run '{}': a load continues from "
                        "its end with the same phases",
                        next.path.string(), before.run.string()));
}

std::vector<std::string> changes(const Scene& before, const Scene& next) {
    std::vector<std::string> found;
    const auto compare = [&](const Phase& phase, const char* what, double its, double mine) {
        if (its != mine)
            found.push_back(fmt::format("[phase.{}] has {} = {:g}, before {:g}", phase.name, what, mine, its));
    };
    for (const Phase& mine : next.phases) {
        const Phase& its = before.phase(mine.label);
        if (its.norton.has_value() != mine.norton.has_value()) {
            found.push_back(
                fmt::format("[phase.{}] is given by {}", mine.name,
                            mine.norton ? "norton, before by its constants" : "its constants, before by norton"));
            continue;
        }
        compare(mine, "K", its.norton.value_or(Norton{}).consistency, mine.norton.value_or(Norton{}).consistency);
        compare(mine, "M", its.norton.value_or(Norton{}).rate_sensitivity,
                mine.norton.value_or(Norton{}).rate_sensitivity);
        compare(mine, "repulsive_stiffness", its.repulsive_stiffness.value_or(0), mine.repulsive_stiffness.value_or(0));
        compare(mine, "natural_period", its.natural_period.value_or(0), mine.natural_period.value_or(0));
        compare(mine, "stiffness_ratio", its.stiffness_ratio, mine.stiffness_ratio);
    }
    if (next.self_contact && !before.self_contact)
        found.push_back("self_contact is on, before off: whatever touches at the beginning is taken for the inside");
    if (!next.self_contact && before.self_contact)
        found.push_back("self_contact is off, before on: surfaces that had met attract each other now");
    return found;
}

std::vector<std::string> check_rest(Packing& sample, const std::string& relaxed_under, const Scene& scene,
                                    Reporter& reporter) {
    if (!sample.relaxed || relaxed_under.empty()) return {};
    const Scene earlier = parse_stored_scene(relaxed_under, "of the relaxed sample");
    const auto crown = [](const Scene& one) { return one.crown_radius / one.seed_radius; };
    if (&earlier.law() != &scene.law() || std::abs(crown(earlier) / crown(scene) - 1) > 1e-9 ||
        earlier.radius_dispersion != scene.radius_dispersion || labels_of(earlier) != labels_of(scene)) {
        sample.relaxed = false;
        reporter.note(
            fmt::format("the sample was relaxed as another material (law \"{}\", crown {:g} seed radii, radius "
                        "dispersion {:g}): it is not at rest under this scene",
                        earlier.law().name(), crown(earlier), earlier.radius_dispersion));
        return {};
    }
    std::vector<std::string> found = changes(earlier, scene);
    if (!found.empty())
        reporter.note(
            fmt::format("since the sample was relaxed: {}. The stress differs from that of a sample relaxed "
                        "anew by no more than between packings (docs/running.md)",
                        fmt::join(found, "; ")));
    return found;
}

Model model_of(const Scene& scene, const Packing& sample, const Continuation* before) {
    return compile_model(scene, sample, before != nullptr ? std::optional(before->end.height) : std::nullopt);
}

void prepare(Continuation& before, const Scene& next, const Model& model) {
    auto& numbers = before.state.checkpoint.numbers;
    const double step = before.state.checkpoint.number("solver_step");
    const double ratio = before.end.time_step / model.time_step;
    const auto moved = [&](double earlier) { return step - std::round((step - earlier) * ratio); };
    numbers["solver_run_clock"] = numbers_of({.step = static_cast<std::int64_t>(step)});
    if (ratio != 1) {
        ParticleState& particles = before.state.checkpoint.particles;
        constexpr std::int32_t outward_words = 3;
        std::size_t word = 0;
        for (const std::int32_t length : particles.memory_length) {
            for (std::int32_t k = outward_words; k < length; k += 2) {
                std::int64_t& since = particles.memory[word + static_cast<std::size_t>(k) + 1];
                since = static_cast<std::int64_t>(moved(static_cast<double>(since)));
            }
            word += static_cast<std::size_t>(length);
        }
    }
    if (next.steps.empty()) {
        numbers.erase("solver_planes");
        numbers.erase("solver_sides");
    }
}

}  // namespace tomodem
