#include "solver_plugin/run/explain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/scene/load_path.hpp"
#include "solver_plugin/run/continuation.hpp"
#include "solver_plugin/run/forewarnings.hpp"
#include "solver_plugin/run/meter.hpp"
#include "solver_plugin/run/scene_walls.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem {
namespace {

constexpr double calibration_seconds = 2;

std::vector<Ingredient> ingredients_of(const Scene& scene, const Packing& sample, const Model& model,
                                       const Continuation* before) {
    const auto names = [&](auto wanted) {
        std::string list;
        for (const Phase& phase : scene.phases)
            if (wanted(phase)) list += fmt::format("{}[phase.{}]", list.empty() ? "" : ", ", phase.name);
        return list;
    };
    const std::string hardening = names([](const Phase& phase) { return phase.hardening.has_value(); });
    std::vector<Ingredient> list;
    const auto add = [&](const std::string& name, bool on, const std::string& why_on, const std::string& why_off) {
        list.push_back({name, on, on ? why_on : why_off});
    };
    const std::string own_law = fmt::format("law \"{}\"", model.law->name());
    for (const Law* law : laws())
        if (!law->traits().feature.empty()) add(law->traits().feature, law == model.law, own_law, own_law);
    add("velocities_that_are_found", model.scheme == Scheme::quasi_static,
        fmt::format("scheme = \"quasi_static\": to a force balance of {:g}", model.imbalance),
        "scheme = \"explicit\": forces accelerate masses");
    add("several_laws", model.phases.size() > 1 || model.objects_only_push,
        model.phases.size() > 1 ? fmt::format("{} phases, mixed pairs take the averages", model.phases.size())
                                : "one phase of several objects",
        "one phase: one set of constants for every pair");
    add("dispersed_radii", model.radius_dispersion > 0 || !sample.radius.empty(),
        sample.radius.empty() ? fmt::format("radius_dispersion = {:g}", model.radius_dispersion)
                              : std::string("the sample's particles have radii of their own"),
        "equal radii: seed and crown are constants");
    add("objects_that_do_not_attract", model.objects_only_push, "objects_only_push = true in [contact]",
        "everything belongs together");
    add("self_contact", model.self_contact, "self_contact = true in [contact]: outward vectors and interfaces",
        "no memory of pairs, no outward vectors");
    add("healing", model.self_contact && std::isfinite(model.healing_time),
        fmt::format("healing_time = {:g} s", model.healing_time), "interfaces stay, or there are none");
    add("hardening", !hardening.empty(), hardening, "strength is constant in time");
    add("planes", !scene.steps.empty(), "steps in [load]", "duration in [load]: walls alone");
    add("walls", !scene.walls.empty(), fmt::format("{} [[wall]]", scene.walls.size()), "no [[wall]]");
    add("periodic_sides", model.lateral != Lateral::free, "lateral in [load]",
        "free sides: no ghosts but those of processes");
    add("flow_initiation", scene.initiation.has_value(), "initiation in [load]", "full rate from the first step");
    add("relaxation_first", !sample.relaxed, "the sample is not relaxed", "the sample is relaxed");
    add("continues_a_run", before != nullptr, "--frame last", "SAMPLE is a sample");
    add("rest_between_the_planes", model.law->traits().planes_pull && before == nullptr, "planes of this law pull",
        before == nullptr ? "planes of this law do not pull at rest" : "the planes are there already");
    add("velocities_in_frames", scene.write_velocity, "velocity = true in [output]", "not asked for");
    add("stresses_in_frames", scene.write_stress, "stress = true in [output]", "not asked for");
    add("rotations_torques_friction", false, "", "the method has none");
    return list;
}

}  // namespace

Explanation explain(const Packing& sample, const Scene& scene, const Continuation* before, MPI_Comm communicator,
                    Reporter& reporter) {
    const Meter meter(communicator);
    const Model model = model_of(scene, sample, before);
    forewarn(scene, sample, model, before, reporter);
    const std::vector<LoadSegment> path = load_path(scene, model);

    Explanation found;
    found.ingredients = ingredients_of(scene, sample, model, before);
    found.flows = expected_flows(scene, static_cast<std::int64_t>(sample.size()), model);
    found.particles = static_cast<std::int64_t>(sample.size());
    found.time_step = model.time_step;
    found.time_step_reason = model.law->time_step_reason(scene, model);
    for (const LoadSegment& segment : path) found.steps += segment.steps;
    const double of_load = model.law->evaluations(model, static_cast<double>(found.steps));
    const std::int64_t load_steps = found.steps;
    if (!sample.relaxed)
        found.steps += relaxation_steps(model, expected_relaxation_periods(static_cast<std::int64_t>(sample.size())));
    if (model.law->traits().planes_pull && before == nullptr) found.steps += relaxation_steps(model, seating_periods);
    const double of_run =
        of_load + model.law->evaluations_at_rest(model) * static_cast<double>(found.steps - load_steps);
    if (model.scheme == Scheme::quasi_static) found.evaluations = std::llround(of_load);

    plugin::Simulation simulation(sample, model, scene.axis, communicator);
    if (!scene.steps.empty()) simulation.place_planes();
    place_walls(simulation, scene, WallsInside::refused);
    simulation.set_loading(path.front());
    simulation.run(0);
    const double set_up = meter.cost(0, 0).wall_seconds;
    const std::int64_t evaluations_before = simulation.evaluations();
    double seconds = 0;
    std::int64_t done = 0, piece = 4;
    const auto begun = std::chrono::steady_clock::now();
    while (done < path.front().steps && seconds < calibration_seconds) {
        piece = std::min(piece, path.front().steps - done);
        simulation.run(piece);
        done += piece;
        piece *= 2;
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        MPI_Bcast(&seconds, 1, MPI_DOUBLE, 0, communicator);
    }
    const Cost cost = meter.cost(done, 0);
    found.processes = cost.processes;
    // The first quasi-static steps take many more evaluations than the others.
    const std::int64_t evaluations = simulation.evaluations() - evaluations_before;
    found.wall_seconds = set_up + seconds / static_cast<double>(evaluations > 0 ? evaluations : done) * of_run;
    found.seconds_per_particle_step =
        seconds / static_cast<double>(done) * cost.processes / static_cast<double>(sample.size());
    found.peak_bytes = cost.peak_bytes;
    return found;
}

}  // namespace tomodem
