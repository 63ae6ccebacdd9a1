// mesh_recon: wrap the particle centres of a sample, a phase or an object in a closed triangle mesh.
#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "core/cli.hpp"
#include "core/mesh.hpp"
#include "core/packing_file.hpp"
#include "tools/mesh_recon/alpha_surface.hpp"
#include "tools/mesh_recon/selection.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path packing, mesh;
    double probe_radius = 0.0;  // mm; 0: one particle diameter
    std::int64_t frame = -1, species = 0, object = 0;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"mesh_recon", "Wrap the particles of a sample, a phase or an object in a closed triangle mesh."}
        .input("INPUT", request.packing, "sample or run (.h5)")
        .output("MESH", request.mesh, "surface to write (.stl, .ply or .vtp)")
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "gaps between centres that a ball of this radius cannot enter are filled; one particle diameter where "
                "not given")
        .option("--frame", request.frame, cli::Unit::none, {.low = -1},
                "frame of a run, counted from 0; -1 is the last")
        .option("--species", request.species, cli::Unit::none, cli::positive, "only the phase of this label")
        .option("--object", request.object, cli::Unit::none, cli::positive, "only the object of this number")
        .exclusive({"--species", "--object"})
        .example("mesh_recon run.h5 inclusions.stl --species 2");
}

void run(const Request& request) {
    const Packing packing = read_packing(request.packing, request.frame);
    Selection selection;
    if (cli::given("--species")) selection.species = request.species;
    if (cli::given("--object")) selection.object = request.object;
    const std::vector<Vec3> centres = selected_centres(packing, selection);
    const double probe_radius =
        cli::given("--probe-radius") ? request.probe_radius : default_probe_radius(packing.seed_radius);

    if (probe_radius > 10 * default_probe_radius(packing.seed_radius))
        cli::warn(fmt::format("a probe of {:g} mm is more than ten particle diameters: little but the hull is left",
                              probe_radius));

    cli::Progress progress("alpha shape", 1.0);
    const AlphaSurface surface =
        alpha_surface(centres, {.probe_radius = probe_radius, .progress = [&](double done) { progress.update(done); }});
    write_mesh(surface.mesh, request.mesh);

    cli::report("particles", std::int64_t(centres.size()));
    cli::report("probe_radius", probe_radius, "mm");
    cli::report("volume", surface.volume, "mm^3");
    cli::report("area", surface.area, "mm^2");
    cli::report("components", std::int64_t(surface.components.size()));
    cli::report("largest_component_volume", surface.components.front(), "mm^3");
    cli::report("triangles", std::int64_t(surface.mesh.triangles.size()));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
