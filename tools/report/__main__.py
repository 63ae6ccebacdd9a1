"""report: one page about a run, with its pictures, curves, tables, topology and a 3-D view; needs no network to be read."""
import argparse
import contextlib
import os
import pathlib
import re
import sys
import tempfile

from command_line import Argument, InvalidInput, Progress, Usage, main, write_atomically
from run_facts import RunFacts, Steps


def size_text(text):
    if not re.fullmatch(r"[1-9]\d{2,3}x[1-9]\d{2,3}", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT with 100 to 9999 pixels each, as 960x720")
    return text


def frames_number(text):
    if not text.isdigit() or not 2 <= int(text) <= 61:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number of at least 2 and at most 61")
    return int(text)


USAGE = Usage(
    "report",
    "One self-contained page about a run: curves, tables, pictures, topology, cost and a 3-D view that can be turned.",
    "picture",
    [Argument("RUN", "input", "Run or sample (.h5) to report on."),
     Argument("REPORT", "output", "Page to write.", formats=(".html", ".htm")),
     Argument("--with", "text", "Use the measures, meshes and pictures that are in this folder, and keep there those that "
                                "have to be made. Without the option they are made for the page and not kept.", "FOLDER"),
     Argument("--title", "text", "Name of the sample, as the page's title. When left out, it is that of the image that the run was made "
                                 "from, or of the run.", "TEXT", str),
     Argument("--quick", "flag", "Leave out all that takes long: make the page of the curves, the shape factors and two pictures. "
                                 "What is in the folder of --with is shown nevertheless."),
     Argument("--frames", "integer", "Frames of the 3-D view and of the measures that look at single frames, at most: evenly spread, the "
                                     "first and the last among them. The page says which.", "INTEGER", frames_number, 11),
     Argument("--size", "text", "Width and height of the pictures in pixels.", "TEXT", size_text, "960x720")],
    ["report run.h5 report.html", "report run.h5 report.html --with out/run", "report run.h5 report.html --quick --title 'Casting 7'"],
)


def tools_folder():
    """Where the other executables are: beside this one, or behind a link to it."""
    return pathlib.Path(os.path.realpath(sys.argv[0])).parent


def layers(run, shop, frames):
    from view_meshes import Layer
    from words import INDIGO, LIGHT_GREY, hexadecimal, object_colour, phase_colours

    def paths(what):
        return {frame: shop.folder / f"view/{what}_{frame:04d}.vtp" for frame in frames if shop.has(f"view/{what}_{frame:04d}")}

    of_phase = phase_colours(run.species, run.matrix)
    found = [Layer("sample", "sample", lambda _: hexadecimal(LIGHT_GREY), paths("sample"))]
    if run.objects:
        found.append(Layer("objects", "objects", object_colour, paths("objects"), numbers="object"))
    for label, colour in of_phase.items():
        if label != run.matrix and label not in run.species_of_objects:
            name = run.names.get(label, f"label {label}")
            found.append(Layer("phase", name, lambda _, colour=colour: colour, paths(f"phase{label}")))
    found.append(Layer("pores", "pores", lambda _: INDIGO, paths("pores")))
    return [one for one in found if one.paths]


def cost_of_view(shop, pieces):
    """One line for the many small steps behind the view."""
    summaries = [shop.summary(piece.name) for piece in pieces if shop.has(piece.name)]
    if not summaries:
        return {}
    total = {key: sum(one[key] for one in summaries) for key in ("wall_seconds", "cpu_seconds")}
    return {"mesh_view": {"tool": "mesh_recon", **total, "peak_bytes": max(one["peak_bytes"] for one in summaries)}}


def run_report(request):
    run = RunFacts(request["RUN"])
    with contextlib.ExitStack() as stack:
        folder = request["--with"]
        if folder is None:
            folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="tomodem-report-")))
        else:
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InvalidInput(f"cannot use --with '{folder}' as a folder: {error.strerror}") from None
        make_page(request, run, folder, stack)


def make_page(request, run, folder, stack):
    import pieces
    import view_meshes
    from page import Page

    tools = pieces.described_tools(tools_folder())
    frames = view_meshes.chosen_frames(run.frame_count, request["--frames"])
    quick = request["--quick"]
    measures, left_out = pieces.measures(run, tools, frames, quick)
    pictures, surfaces = pieces.pictures(run, request["--size"], quick), [] if quick else pieces.surfaces(run, frames)
    shop = stack.enter_context(pieces.Workshop(run, folder, tools_folder(), tools, request))
    if quick and request["--with"]:
        # What is there costs nothing.
        all_measures, left_out = pieces.measures(run, tools, frames, quick=False)
        all_pictures = pieces.pictures(run, request["--size"], quick=False)
        kept = shop.kept([*all_measures, *all_pictures])
        left_out |= {one.name: "left out by --quick" for one in all_measures if one not in measures and one not in kept}
        measures = [one for one in all_measures if one.name not in left_out]
        pictures = [one for one in all_pictures if one in pictures or one in kept]
        surfaces = shop.kept(pieces.surfaces(run, frames))
    wanted = [*measures, *pictures, *surfaces]
    progress = stack.enter_context(Progress(request, len(wanted) + 2))
    shop.make_all(wanted, progress)

    progress.begin("3-D view")
    view = view_meshes.View(layers(run, shop, frames), frames, request.threads)
    progress("3-D view")
    progress.begin("page")
    displays = {piece.name: tools[piece.tool]["display"] for piece in measures if shop.has(piece.name)}
    left_out |= {name: reason for name, reason in {**shop.not_possible, **shop.failed}.items() if name in tools}
    page = Page(run, shop, Steps(run, [folder, run.path.parent]), displays,
                {name: tools[name]["display"]["heading"] for name in left_out if name in tools}, left_out,
                {"frames": view.frames, "layers": view.layers, "bounds": view.bounds, "triangles": view.triangles, "notes": view.notes,
                 "left_out": "left out by --quick" if quick else "", "costs": cost_of_view(shop, surfaces)},
                request["--title"])
    text = page.text()
    write_atomically(request["REPORT"], text)

    request.report("frames", run.frame_count)
    request.report("frames_of_view", len(view.frames))
    request.report("triangles_of_view", view.triangles)
    request.report("pieces_made", len(shop.made))
    request.report("pieces_reused", len(shop.reused))
    request.report("events", len(page.events))
    request.report("size", round(len(text.encode()) / 1e6, 3), "MB")
    for line in page.warnings():
        request.warn(line)


if __name__ == "__main__":
    from version import VERSION

    sys.exit(main(USAGE, VERSION, run_report))
