// render: draw a sample, a run or a mesh as PNG pictures or as a movie; no screen is needed.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/cli/volume_cli.hpp"
#include "core/mesh/mesh.hpp"
#include "core/packing/packing_file.hpp"
#include "core/scene/scene.hpp"
#include "tools/render/series.hpp"
#include "tools/render/subject.hpp"

namespace tomodem::render {
namespace {

struct Request {
    std::filesystem::path input, picture, view_of;
    std::int64_t only_species = 0, turntable = 0;
    double cut_place = 0.5, slice_place = 0.5, opacity = 0.18, pictures_per_second = 12.0, probe_radius = 0.0,
           lid_radius = 0.0;
    std::string frames = "last", colour = "phase", range, cut = "none", slice = "none", arrows, press = "none", labels,
                names;
    std::string frame = "last", size = "1200x900", background = "white";
    bool objects = false, pores = false, no_outline = false;
};

constexpr cli::Range share{0, 1, true, true};

cli::Usage usage(Request& request) {
    return cli::Usage{"render", "Draw a sample, a run or a mesh as PNG pictures or as a movie; no screen is needed."}
        .input("INPUT", request.input, "Sample or run (.h5), or mesh (.stl, .ply).")
        .output("PICTURE", request.picture,
                "Picture or movie to write. Several pictures are named NAME_0000.png and so on; a movie needs ffmpeg.",
                {".png", ".mp4"})
        .option("--frame", request.frame, "Frame to draw: first, last or a number from 0.")
        .option("--frames", request.frames,
                "Frames to draw: all, first, last, a number from 0, or several as 0,5,last. A movie has all of them.")
        .option("--names", request.names,
                "Call the pictures of --frames NAME_before.png and so on instead of NAME_0000.png: one name for each "
                "frame, as before,after.")
        .option("--turntable", request.turntable, cli::Unit::none, {.low = 2},
                "Draw one frame in this number of pictures, from all sides.")
        .option("--pictures-per-second", request.pictures_per_second, cli::Unit::none, cli::positive,
                "Speed of a movie.")
        .option("--color", request.colour,
                "What the colours show: phase, object, none, or a quantity of the file: a property, a field of the "
                "particles, its component (stress_zz) or its length (velocity).")
        .option("--range", request.range,
                "Values at the ends of the colour scale, as LOW,HIGH in the unit of the file. When left out, the scale "
                "holds 98 % of the values of every frame.")
        .option("--only-species", request.only_species, cli::Unit::none, cli::any,
                "Show only the phase of this label. When left out, all phases are shown.")
        .choice(
            "--cut", request.cut, {"x", "y", "auto", "none"},
            "Cut the sample open across this axis and show its inside; auto cuts where the largest area of objects, "
            "minor phases and pores of the first frame is.")
        .option("--cut-place", request.cut_place, cli::Unit::fraction, share,
                "Place of the cut in the first frame, from the lower (0) to the upper end (1) of the sample; in other "
                "frames the cut goes through the same material.")
        .choice("--slice", request.slice, {"x", "y", "z", "none"},
                "Show only a layer across this axis, one particle diameter thick, in front view.")
        .option("--slice-place", request.slice_place, cli::Unit::fraction, share,
                "Place of the slice, from the lower (0) to the upper end (1) of the sample.")
        .option("--arrows", request.arrows,
                "Draw these vectors as arrows in the slice of --slice: velocity, outward (with self_contact in the "
                "scene), or another field of the run with three components.")
        .flag("--objects", request.objects, "Draw the surfaces of the objects in a translucent sample, not particles.")
        .flag("--pores", request.pores, "Draw the closed pores in a translucent sample, not particles.")
        .option("--probe-radius", request.probe_radius, cli::Unit::length, cli::positive,
                "Probe radius of the surfaces, as in mesh_recon. When left out, it is one particle diameter.")
        .option(
            "--lid-radius", request.lid_radius, cli::Unit::length, cli::positive,
            "With --pores, also draw pores that are open to the outside; a lid, the surface on which a ball of this "
            "radius rolls over the sample, closes them. Without it, only closed pores are drawn.")
        .option("--opacity", request.opacity, cli::Unit::fraction, share,
                "Opacity of the sample around the surfaces that --objects or --pores draws: 0 is invisible, 1 opaque.")
        .choice("--press", request.press, {"x", "y", "z", "none"}, "Show the two press planes across this axis.")
        .flag("--no-outline", request.no_outline, "Leave out the thin box around the sample in its first frame.")
        .input_option("--view-of", request.view_of,
                      "Use the view and scale of the picture of this sample or run (.h5), to compare pictures.")
        .option(
            "--labels", request.labels,
            "Names of the phases in the legend, as 1=matrix,2=inclusion. When left out, they are those of the scene "
            "of the run.")
        .option("--size", request.size, "Width and height of the picture in pixels.")
        .choice("--background", request.background, {"white", "grey"}, "Colour behind the sample.")
        .exclusive({"--frame", "--frames"})
        .exclusive({"--frames", "--turntable"})
        .exclusive({"--cut", "--slice", "--objects"})
        .exclusive({"--cut", "--slice", "--pores"})
        .exclusive({"--slice", "--turntable"})
        .step(cli::Step::picture)
        .threads()
        .example("render run.h5 before.png --frame 0 --cut y --press z")
        .example("render run.h5 inside.png --cut auto")
        .example("render run.h5 inclusions.png --only-species 2 --color object")
        .example("render run.h5 stress.mp4 --color stress_zz --cut y")
        .example("render run.h5 pores.png --pores --objects")
        .example("render run.h5 outward.png --slice y --arrows outward")
        .example("render run.h5 around.mp4 --turntable 90 --objects")
        .example("render inclusion.stl inclusion.png --view-of run.h5");
}

struct Size {
    int width = 0, height = 0;
};

Size parse_size(const std::string& text) {
    Size size;
    int used = 0;
    if (std::sscanf(text.c_str(), "%dx%d%n", &size.width, &size.height, &used) != 2 ||
        used != static_cast<int>(text.size()) || size.width < 100 || size.height < 100 || size.width > 8000 ||
        size.height > 8000)
        throw WrongUsage(
            fmt::format("--size '{}' is not WIDTHxHEIGHT with 100 to 8000 pixels each, as 1200x900", text));
    return size;
}

std::optional<std::pair<double, double>> parse_range(const std::string& text) {
    if (text.empty()) return std::nullopt;
    double low = 0, high = 0;
    int used = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf%n", &low, &high, &used) != 2 || used != static_cast<int>(text.size()) ||
        !std::isfinite(low) || !std::isfinite(high) || low >= high)
        throw WrongUsage(fmt::format("--range '{}' is not LOW,HIGH with LOW below HIGH, as -2e8,2e8", text));
    return std::pair{low, high};
}

std::optional<int> parse_axis(const std::string& axis) {
    return axis == "none" ? std::nullopt : std::optional<int>(axis[0] - 'x');
}

CutPlane cut_plane(const Request& request, const Packing& packing) {
    if (request.cut == "none") return {};
    if (request.cut == "auto") return best_cut(packing);
    CutPlane plane{.cut = request.cut == "x" ? Cut::x : Cut::y};
    const Box box = bounds(packing.position, packing.seed_radius);
    plane.place = box.origin[plane.axis()] + request.cut_place * box.edges[plane.axis()];
    return plane;
}

std::map<std::int32_t, std::string> phase_names(const Request& request, const Provenance& provenance) {
    if (!request.labels.empty()) return parse_label_names("--labels", request.labels);
    std::map<std::int32_t, std::string> names;
    if (!provenance.scene.empty())
        for (const Phase& phase : parse_stored_scene(provenance.scene, "of " + request.input.string()).phases)
            names[phase.label] = phase.name;
    return names;
}

/// Options that need another one, or cannot go with it.
void check_combination(const Request& request, cli::Tool& tool) {
    const bool quantity = request.colour != "phase" && request.colour != "object" && request.colour != "none";
    if (!request.range.empty() && !quantity)
        throw WrongUsage("--range goes with --color and a quantity of the file, such as stress_zz");
    if (!request.arrows.empty() && request.slice == "none")
        throw WrongUsage("--arrows are drawn in a slice; give --slice x, y or z");
    if (tool.given("--cut-place") && request.cut != "x" && request.cut != "y")
        throw WrongUsage("--cut-place goes with --cut x or y");
    if (tool.given("--slice-place") && request.slice == "none")
        throw WrongUsage("--slice-place goes with --slice x, y or z");
    for (const char* flag : {"--color", "--only-species"})
        if ((request.objects || request.pores) && tool.given(flag))
            throw WrongUsage(fmt::format("{} applies to particles, but --objects and --pores draw surfaces", flag));
    for (const char* flag : {"--probe-radius", "--opacity"})
        if (!request.objects && !request.pores && tool.given(flag))
            throw WrongUsage(fmt::format("{} goes with --objects or --pores", flag));
    if (!request.pores && tool.given("--lid-radius")) throw WrongUsage("--lid-radius goes with --pores");
    if (tool.given("--names") && (!tool.given("--frames") || request.picture.extension() == ".mp4"))
        throw WrongUsage("--names goes with --frames and pictures");
    if (request.picture.extension() != ".mp4" && tool.given("--pictures-per-second"))
        throw WrongUsage("--pictures-per-second needs a movie, whose name ends in .mp4");
}

SubjectOptions subject_options(const Request& request, const RunReader& run, cli::Tool& tool) {
    SubjectOptions options;
    options.colour = request.colour;
    options.range = parse_range(request.range);
    if (tool.given("--only-species")) options.only_species = static_cast<std::int32_t>(request.only_species);
    options.cut = cut_plane(request, run.packing());
    options.slice = parse_axis(request.slice);
    options.slice_place = request.slice_place;
    options.arrows = request.arrows;
    options.objects = request.objects;
    options.pores = request.pores;
    options.opacity = request.opacity;
    options.probe_radius = request.probe_radius;
    options.lid_radius = request.lid_radius;
    options.press = parse_axis(request.press);
    options.outline = !request.no_outline;
    options.names = phase_names(request, run.provenance());
    return options;
}

/// The size, view and outline that the user asked for.
class Framing {
 public:
    Framing(const Request& request, Cut cut) : request_(request), size_(parse_size(request.size)) {
        if (request.view_of.empty()) return;
        const RunReader other(request.view_of);
        view_ = view_of(bounds_of_run(other), cut, parse_axis(request.slice));
        if (!request.no_outline) outline_ = bounds(other.packing().position, other.packing().seed_radius);
    }

    /// @param turn  share of a whole turn, of a turntable
    void apply(double turn, Picture& picture) const {
        picture.width = size_.width;
        picture.height = size_.height;
        if (request_.background == "grey") picture.background = {225, 227, 230};
        if (view_) picture.view = *view_;
        if (outline_) picture.outline = outline_;
        if (request_.turntable > 0) picture.view = turned(picture.view, turn);
    }

 private:
    const Request& request_;
    Size size_;
    std::optional<View> view_;
    std::optional<Box> outline_;
};

Series series(const Request& request, std::vector<std::string> endings) {
    return {
        .output = request.picture, .endings = std::move(endings), .pictures_per_second = request.pictures_per_second};
}

std::vector<std::string> numbered(const std::vector<std::size_t>& numbers) {
    std::vector<std::string> endings;
    for (const std::size_t number : numbers) endings.push_back(fmt::format("{:04}", number));
    return endings;
}

/// @throws WrongUsage unless there is a name for each frame, of letters, digits and _ . -
std::vector<std::string> parse_names(const std::string& text, std::size_t frames) {
    std::vector<std::string> names;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) names.push_back(word);
    const auto fits = [](const std::string& word) {
        return !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char letter) {
            return std::isalnum(letter) || letter == '_' || letter == '.' || letter == '-';
        });
    };
    if (!std::all_of(names.begin(), names.end(), fits))
        throw WrongUsage(
            fmt::format("--names '{}': give names of letters, digits, '_', '.' and '-', as before,after", text));
    if (names.size() != frames || std::set(names.begin(), names.end()).size() != frames)
        throw WrongUsage(fmt::format("--names '{}': give one name for each of the {} frames, each once", text, frames));
    return names;
}

std::vector<std::size_t> counted(std::size_t count) {
    std::vector<std::size_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    return numbers;
}

void draw_run(const Request& request, cli::Tool& tool) {
    const RunReader run(request.input);
    const auto turns = static_cast<std::size_t>(request.turntable);
    const bool all = request.frames == "all" || (request.picture.extension() == ".mp4" && turns == 0);
    std::vector<std::size_t> frames = counted(run.frame_count());
    if (!all)
        frames = tool.given("--frame") ? std::vector{cli::chosen_frame(request.frame, run.frame_count())}
                                       : cli::chosen_frames(request.frames, run.frame_count());
    std::vector<std::string> endings;
    if (turns > 0)
        endings = numbered(counted(turns));
    else if (!request.names.empty())
        endings = parse_names(request.names, frames.size());
    else if (all || frames.size() > 1)
        endings = numbered(frames);
    const SubjectOptions options = subject_options(request, run, tool);
    const Subject subject(run, options, frames);
    const Framing framing(request, options.cut.cut);
    std::size_t shown = 0;
    draw_series(
        series(request, std::move(endings)),
        [&](std::size_t k) {
            Picture picture = subject.picture(turns > 0 ? frames.front() : frames[k]);
            shown = picture.centres.size();
            framing.apply(turns > 0 ? static_cast<double>(k) / static_cast<double>(turns) : 0, picture);
            return picture;
        },
        tool.threads(), tool);
    tool.report("particles", static_cast<std::int64_t>(run.packing().size()));
    if (shown > 0) tool.report("particles_shown", static_cast<std::int64_t>(shown));
    if (options.cut.cut != Cut::none)
        tool.report("cut", fmt::format("{} = {}", "xy"[options.cut.axis()], value_text(options.cut.place, "mm")));
    if (const auto& range = subject.range()) {
        tool.report("color_low", range->low, subject.unit());
        tool.report("color_high", range->high, subject.unit());
    }
    tool.report("pictures", static_cast<std::int64_t>(turns > 0 ? turns : frames.size()));
}

void draw_mesh(const Request& request, cli::Tool& tool) {
    for (const char* flag : {"--frame", "--frames", "--names", "--color", "--range", "--only-species", "--cut",
                             "--slice", "--arrows", "--objects", "--pores", "--press", "--labels"})
        if (tool.given(flag)) throw WrongUsage(fmt::format("{} does not go with a mesh", flag));
    const TriangleMesh mesh = read_mesh(request.input);
    const Framing framing(request, Cut::none);
    const auto turns = static_cast<std::size_t>(request.turntable);
    draw_series(
        series(request, numbered(counted(turns))),
        [&](std::size_t k) {
            Picture picture;
            picture.surfaces.push_back({mesh, std::vector<Rgb>(mesh.vertices.size(), mesh_colour), 1.0});
            picture.view = view_of(bounds(mesh.vertices, 0), Cut::none);
            framing.apply(turns > 0 ? static_cast<double>(k) / static_cast<double>(turns) : 0, picture);
            return picture;
        },
        tool.threads(), tool);
    tool.report("triangles", static_cast<std::int64_t>(mesh.triangles.size()));
}

void run(const Request& request, cli::Tool& tool) {
    const auto picture = request.picture.extension(), input = request.input.extension();
    if (picture != ".png" && picture != ".mp4")
        throw WrongUsage(
            fmt::format("PICTURE '{}': the name must end in .png, or in .mp4 for a movie", request.picture.string()));
    const bool mesh = input == ".stl" || input == ".ply";
    if (picture == ".mp4" && (tool.given("--frame") || request.frames != "last") && request.frames != "all" &&
        request.turntable == 0)
        throw WrongUsage("a movie has all frames; for one frame give a name that ends in .png, or --turntable");
    if (picture == ".mp4" && mesh && request.turntable == 0)
        throw WrongUsage("a movie of a mesh turns around it: give --turntable");
    check_combination(request, tool);
    if (mesh)
        draw_mesh(request, tool);
    else
        draw_run(request, tool);
}
}  // namespace
}  // namespace tomodem::render

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::render::usage, tomodem::render::run);
}
