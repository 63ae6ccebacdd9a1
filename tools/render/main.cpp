// render: draw a packing, a frame of a run or a mesh as a PNG picture; needs no screen.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "core/cli.hpp"
#include "core/mesh.hpp"
#include "core/packing_file.hpp"
#include "core/scene.hpp"
#include "core/volume_cli.hpp"
#include "tools/render/appearance.hpp"
#include "tools/render/picture.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path input, picture, view_of;
    std::int64_t frame = -1, only_species = 0;
    std::string colour = "phase", cut = "none", size = "1200x900", background = "white", press = "none", labels;
    bool no_outline = false;
};

cli::Usage usage(Request& request) {
    return cli::Usage{"render", "Draw a packing, a frame of a run or a mesh as a PNG picture; needs no screen."}
        .input("INPUT", request.input, "sample or run (.h5), or mesh (.stl, .ply)")
        .output("PICTURE", request.picture, "picture to write (.png)")
        .option("--frame", request.frame, cli::Unit::none, {.low = -1},
                "frame of a run, counted from 0; -1 is the last")
        .choice("--color", request.colour, {"phase", "object", "none"}, "what the colours tell apart")
        .option("--only-species", request.only_species, cli::Unit::none, cli::any, "show only the phase of this label")
        .choice("--cut", request.cut, {"x", "y", "none"}, "cut the sample open in its middle, across this axis")
        .choice("--press", request.press, {"x", "y", "z", "none"}, "show the two press planes across this axis")
        .flag("--no-outline", request.no_outline, "leave out the thin box around the first frame")
        .input_option("--view-of", request.view_of,
                      "sample or run (.h5) whose place and scale are used, to compare pictures of several files")
        .option("--labels", request.labels, "names of the phases, as 1=matrix,2=inclusion; a run knows its own")
        .option("--size", request.size, "width and height in pixels")
        .choice("--background", request.background, {"white", "grey"}, "colour behind the sample")
        .example("render run.h5 before.png --frame 0 --cut y --press z")
        .example("render run.h5 inclusions.png --only-species 2 --color object")
        .example("render inclusion.stl inclusion.png --view-of run.h5");
}

void parse_size(const std::string& text, Picture& picture) {
    int used = 0;
    if (std::sscanf(text.c_str(), "%dx%d%n", &picture.width, &picture.height, &used) != 2 ||
        used != static_cast<int>(text.size()) || picture.width < 100 || picture.height < 100 || picture.width > 8000 ||
        picture.height > 8000)
        throw WrongUsage(
            fmt::format("--size '{}' is not WIDTHxHEIGHT with 100 to 8000 pixels each, as 1200x900", text));
}

Cut cut_across(const std::string& axis) {
    return axis == "x" ? Cut::x : axis == "y" ? Cut::y : Cut::none;
}

std::map<std::int32_t, std::string> phase_names(const Request& request, const Provenance& provenance) {
    if (!request.labels.empty()) return parse_label_names("--labels", request.labels);
    std::map<std::int32_t, std::string> names;
    if (!provenance.scene.empty())
        for (const Phase& phase : parse_scene(provenance.scene, "of " + request.input.string()).phases)
            names[phase.label] = phase.name;
    return names;
}

/// Slabs that touch the outermost particles, cut like the sample.
std::vector<Box> press_planes(const Box& sample, int axis, Cut cut) {
    Box lower = sample;
    const double thickness = 0.01 * sample.edges.maxCoeff();
    lower.origin -= 0.05 * sample.edges;
    lower.edges *= 1.1;
    if (cut == Cut::x && axis != 0) lower.edges.x() /= 2;
    if (cut == Cut::y && axis != 1) lower.origin.y() += lower.edges.y() /= 2;
    lower.edges[axis] = thickness;
    lower.origin[axis] = sample.origin[axis] - thickness;
    Box upper = lower;
    upper.origin[axis] = sample.origin[axis] + sample.edges[axis];
    return {lower, upper};
}

std::string strain_text(double strain) {
    const std::string text = fmt::format("{:.3f}", std::abs(strain));
    return fmt::format("true strain {}{}", strain < 0 && text != "0.000" ? "−" : "", text);
}

void add_particles(const Request& request, Picture& picture) {
    const RunReader run(request.input);
    const auto frames = static_cast<std::int64_t>(run.frame_count());
    const Frame frame = run.frame(request.frame < 0 ? frames - 1 : request.frame);
    const Packing& packing = run.packing();

    Appearance appearance;
    appearance.cut = cut_across(request.cut);
    appearance.names = phase_names(request, run.provenance());
    appearance.colour = request.colour == "phase"    ? ColourBy::phase
                        : request.colour == "object" ? ColourBy::object
                                                     : ColourBy::none;
    if (cli::given("--only-species")) appearance.only_species = static_cast<std::int32_t>(request.only_species);

    const Box first = bounds(packing.position, packing.seed_radius);
    show(packing, frame.position, first.origin + first.edges / 2, appearance, picture);
    picture.view = view_of(bounds_of_run(run), appearance.cut);
    if (!request.no_outline) picture.outline = first;
    if (request.press != "none")
        picture.plates =
            press_planes(bounds(frame.position, packing.seed_radius), request.press[0] - 'x', appearance.cut);
    if (const auto strain = run.observables().find("strain"); strain != run.observables().end()) {
        if (!picture.caption.empty()) picture.caption += ", ";
        picture.caption += strain_text(value_at(strain->second, frame.time));
    }
    cli::report("particles", static_cast<std::int64_t>(packing.size()));
    cli::report("particles_shown", static_cast<std::int64_t>(picture.centres.size()));
}

void add_mesh(const Request& request, Picture& picture) {
    for (const char* flag : {"--frame", "--color", "--only-species", "--cut", "--press", "--labels"})
        if (cli::given(flag)) throw WrongUsage(fmt::format("{} does not go with a mesh", flag));
    picture.mesh = read_mesh(request.input);
    picture.mesh_colour = {213, 94, 0};
    picture.view = view_of(bounds(picture.mesh.vertices, 0), Cut::none);
    cli::report("triangles", static_cast<std::int64_t>(picture.mesh.triangles.size()));
}

void run(const Request& request) {
    if (request.picture.extension() != ".png")
        throw WrongUsage(fmt::format("picture '{}': the name must end in .png", request.picture.string()));
    Picture picture;
    parse_size(request.size, picture);
    if (request.background == "grey") picture.background = {225, 227, 230};

    const auto extension = request.input.extension();
    if (extension == ".stl" || extension == ".ply")
        add_mesh(request, picture);
    else
        add_particles(request, picture);
    if (!request.view_of.empty()) {
        const RunReader other(request.view_of);
        picture.view = view_of(bounds_of_run(other), cut_across(request.cut));
        if (!request.no_outline) picture.outline = bounds(other.packing().position, other.packing().seed_radius);
    }
    draw(picture, request.picture);
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
