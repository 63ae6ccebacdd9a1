// relax: let a free sample come to rest under its law.
#include <fmt/format.h>

#include <cmath>

#include "core/cli/cli.hpp"
#include "core/packing/packing_file.hpp"
#include "solver_plugin/run/forewarnings.hpp"
#include "solver_plugin/run/mpi_session.hpp"
#include "solver_plugin/run/solver.hpp"

namespace tomodem::relax {
namespace {

struct Request {
    std::filesystem::path sample, scene, relaxed;
    RestLimits limits;
};

cli::Usage usage(Request& request) {
    return cli::Usage("relax", "Let a free sample come to rest under its law.")
        .input("SAMPLE", request.sample, "Sample of particles (.h5).")
        .input("SCENE", request.scene,
               "Scene (.toml, docs/scene.md) that gives the phases of the sample and the law by which it relaxes.")
        .output("RELAXED", request.relaxed, "Sample at rest to write.", {".h5"})
        .option(
            "--energy-ratio", request.limits.energy_ratio, cli::Unit::none, cli::positive,
            "Kinetic over elastic energy up to which the sample counts as at rest. By default that of the law: 1e-5, "
            "norton 1e-3.")
        .option(
            "--force-balance", request.limits.force_balance, cli::Unit::none, cli::positive,
            "Net force on a particle over the sum of its forces up to which the sample counts as at rest. By default "
            "that of the law: 1e-3, norton 1e-2.")
        .option(
            "--max-periods", request.limits.max_periods, cli::Unit::none, cli::positive,
            "Number of natural periods after which the relaxation ends with a warning if the sample is not at rest.")
        .step(cli::Step::sample)
        .example("relax sample.h5 scene.toml relaxed.h5");
}

Vec3 extent_of(const Packing& packing) {
    Vec3 low = packing.position.front(), high = low;
    for (const Vec3& point : packing.position) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    return high - low;
}

/// A structure of thin parts may draw together while it comes to rest.
void report_extent(const Packing& before, const Packing& after, cli::Tool& tool) {
    const Vec3 old_extent = extent_of(before), extent = extent_of(after);
    double volume = 1;
    for (int axis = 0; axis < 3; ++axis) {
        tool.report(fmt::format("extent_{}", "xyz"[axis]), extent[axis], "mm");
        if (old_extent[axis] > 0) volume *= extent[axis] / old_extent[axis];
    }
    tool.report("box_volume_change", 100 * (volume - 1), "%");
    // Faces draw in by a good part of a particle; from D = 0.70 a sample of BILIN grows by 8 %.
    const double across = std::cbrt(static_cast<double>(before.size()));
    if (volume - 1 < -0.05 - 0.5 / across || volume - 1 > 0.15)
        tool.warn(
            fmt::format("the sample changed its box by {:+.3g} % in volume: its parts may be too thin to keep their "
                        "shape, or its density far from that of its law",
                        100 * (volume - 1)));
}

void run(const Request& request, cli::Tool& tool) {
    const Scene scene = read_scene(request.scene);
    const Packing sample = read_sample(request.sample);
    check_names(scene, sample);
    for (const std::string& line : other_names(scene, sample)) tool.warn(line);
    warn_of_density(scene, sample, tool);
    Provenance provenance = tool.provenance();
    provenance.scene = scene.text;
    if (!scene.calibration_file.empty())
        provenance.inputs[scene.calibration_file.string()] = content_digest(scene.calibration_file);
    const Relaxation result = come_to_rest(sample, scene, request.limits, MPI_COMM_WORLD, tool);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0) {  // where the sample is complete
        write_packing(result.sample, request.relaxed, provenance);
        report_extent(sample, result.sample, tool);
    }
    tool.report("particles", static_cast<std::int64_t>(sample.size()));
    tool.report("steps", result.cost.steps);
    if (result.cost.evaluations > 0) tool.report("evaluations", result.cost.evaluations);
    tool.report("at_rest", static_cast<std::int64_t>(result.at_rest));
    tool.report("periods", result.periods);
    tool.report("energy_ratio", result.energy_ratio);
    tool.report("force_balance", result.force_balance);
    tool.report("residual_energy", result.residual_energy, "N k_rep r_s^2");
    tool.report("largest_displacement", result.largest_displacement, "r_s");
    tool.report("processes", static_cast<std::int64_t>(result.cost.processes));
    tool.report("wall_seconds", result.cost.wall_seconds, "s");
    tool.report("cpu_seconds", result.cost.cpu_seconds, "s");
    tool.report("peak_bytes", result.cost.peak_bytes, "B");
}

}  // namespace
}  // namespace tomodem::relax

int main(int argc, char** argv) {
    using namespace tomodem;
    MpiSession mpi(argc, argv);
    return mpi.end(
        cli::main(argc, argv, relax::usage, relax::run, mpi.first() ? cli::Voice::heard : cli::Voice::silent));
}
