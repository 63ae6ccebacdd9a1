#include "solver_plugin/run/forewarnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/scene/expected_flow.hpp"
#include "core/scene/load_path.hpp"
#include "solver_plugin/run/continuation.hpp"
#include "solver_plugin/run/guards.hpp"

namespace tomodem {
namespace {

void warn_of_hardening(const Scene& scene, double end, Reporter& reporter) {
    for (const Phase& phase : scene.phases) {
        if (!phase.hardening) continue;
        if (const auto& table = phase.hardening->table; !table.empty() && table.back()[0] < end)
            reporter.warn(
                fmt::format("hardening of [phase.{}] ends at {:g} s and the load at {:g} s: its strength "
                            "stays constant between them",
                            phase.name, table.back()[0], end));
    }
}

}  // namespace

void warn_of_density(const Scene& scene, const Packing& sample, Reporter& reporter) {
    constexpr double tolerance = 0.01;
    const LawTraits& law = scene.law().traits();
    const std::array<bool, 3>& periodic = sample.box.periodic;
    const bool brick = std::all_of(periodic.begin(), periodic.end(), [](bool one) { return one; });
    const double density = sample.brick_density > 0 ? sample.brick_density : brick ? sample.density() : 0;
    if (!law.keeps_density || sample.relaxed || density == 0 || std::abs(density - law.packing_density) <= tolerance)
        return;
    const double change = density / law.packing_density - 1;
    reporter.warn(fmt::format(
        "the sample's packing has a density of {:.3g}, and law \"{}\" is at rest at {:g}: the sample will "
        "{} by about {:.0f} % in volume; make the brick with packgen --law {}",
        density, law.name, law.packing_density, change > 0 ? "grow" : "shrink", 100 * std::abs(change), law.name));
}

void forewarn(const Scene& scene, const Packing& sample, const Model& model, const Continuation* before,
              Reporter& reporter) {
    check_plane_speed(scene, model, sample, reporter);
    if (before != nullptr)
        for (const std::string& line : changes(before->scene, scene)) reporter.warn(line);
    for (const std::string& line : other_names(scene, sample)) reporter.warn(line);
    for (const ExpectedFlow& one : expected_flows(scene, static_cast<std::int64_t>(sample.size()), model))
        if (!one.outside.empty())
            reporter.note(
                fmt::format("[phase.{}] is outside its calibration: {}", one.phase, fmt::join(one.outside, "; ")));
    if (before == nullptr) warn_of_density(scene, sample, reporter);
    if (!sample.relaxed) reporter.note("the sample is not relaxed yet: it is relaxed before the load");
    model.law->warn(scene, model, reporter);
    double end = before != nullptr ? before->time() : 0;
    for (const LoadSegment& segment : load_path(scene, model))
        end += segment.time_step * static_cast<double>(segment.steps);
    warn_of_hardening(scene, end, reporter);
}

}  // namespace tomodem
