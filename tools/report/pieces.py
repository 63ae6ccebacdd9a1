"""The pieces of a page, made by the executables that stand beside this one; those that are there already are used again.

A piece is there if all its files are, none is older than what it is made of, and its summary says that it was made of that.
"""
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import shlex
import subprocess
import threading
import time

from command_line import InvalidInput
from run_facts import Steps, real_paths


LONG_MEASURES = 3  # pores, topology, volume_change: each wraps the particles of every frame


@dataclasses.dataclass(frozen=True)
class Piece:
    name: str  # of its summary, NAME.json
    tool: str
    words: tuple  # of the command line, after the run
    files: tuple  # names of what it makes, the output of the command first
    source: str = ""  # another piece's file in the place of the run
    wide: bool = False  # a measure of the whole run, which may take several threads
    optional: bool = False  # no warning where it cannot be made
    kept_with: tuple = ()  # words that the command of a kept one must have
    output: str = ""  # of the command, where it is none of the files


class Workshop:
    def __init__(self, run, folder, tools_folder, tools, request):
        self.run, self.folder, self.tools_folder, self.tools, self.request = run, folder, tools_folder, tools, request
        self.made, self.reused, self.failed, self.not_possible = [], [], {}, {}
        self.children, self.lock = set(), threading.Lock()
        (folder / "view").mkdir(parents=True, exist_ok=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def stop(self):
        with self.lock:
            for child in self.children:
                child.terminate()

    def there(self, piece):
        files = [self.folder / name for name in (*piece.files, f"{piece.name}.json")]
        source = self.folder / piece.source if piece.source else self.run.path
        try:
            if min(path.stat().st_mtime_ns for path in files) < source.stat().st_mtime_ns:
                return False
        except OSError:
            return False
        summary = Steps.read(files[-1])
        if summary is None or summary["tool"] != piece.tool:
            return False
        words = shlex.split(summary["command_line"])
        if not set(piece.kept_with) <= set(words):
            return False
        return os.path.realpath(source) in real_paths(words[1:2], self.run.path.parent)

    def kept(self, pieces):
        """Those that are there, and what they are made of too."""
        maker = {file: piece for piece in pieces for file in piece.files}
        return [one for one in pieces if self.there(one) and (not one.source or self.there(maker[one.source]))]

    def executable(self, tool):
        path = self.tools_folder / tool
        if not os.access(path, os.X_OK):
            raise InvalidInput(f"the executable {tool} is not at '{path}'; build all of tomodem, or install it")
        return path

    def keep_what_is_not_ours(self, piece):
        """A run named as a measure is may have its own summary where the measure's would go."""
        path = self.folder / f"{piece.name}.json"
        summary = Steps.read(path)
        if summary is not None and summary["tool"] != piece.tool:
            raise InvalidInput(f"'{path}' is a summary of {summary['tool']}, and would be written over by that of {piece.tool}; "
                               "give another folder with --with")

    def make(self, piece, threads):
        source = self.folder / piece.source if piece.source else self.run.path
        outputs = {name: self.folder / name for name in piece.files}
        words = [str(outputs.get(word, word)) for word in piece.words]
        if self.tools[piece.tool]["threads"]:
            words += ["--threads", str(threads)]
        command = [self.executable(piece.tool), source, self.folder / (piece.output or piece.files[0]), *words, "--quiet",
                   "--json", self.folder / f"{piece.name}.json"]
        child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                 text=True, errors="replace")
        with self.lock:
            self.children.add(child)
        _, complaint = child.communicate()
        with self.lock:
            self.children.discard(child)
        if child.returncode == 0:
            self.made.append(piece.name)
        else:
            line = complaint.strip().splitlines()[-1:] or [f"{piece.tool}: ended with status {child.returncode}"]
            (self.not_possible if piece.optional else self.failed)[piece.name] = line[0]

    def make_all(self, pieces, progress):
        """Beside each other, as many as there are threads, in their order; those of whole runs come first, as they take longest.

        A piece that cannot be made is in `failed`, with the tool's own words: the page is made without it.
        """
        todo = []
        for piece in pieces:
            stale = any(piece.source in one.files for one in todo)
            if not stale and self.there(piece):
                self.reused.append(piece.name)
                progress(piece.name)
            else:
                self.executable(piece.tool)
                if piece.tool not in self.tools:
                    raise InvalidInput(f"'{self.tools_folder / 'tools.json'}' does not hold {piece.tool}; build all of tomodem")
                self.keep_what_is_not_ours(piece)
                todo.append(piece)
        # On one thread each, nothing waits for the serial part of another one; many cores are shared by the long ones.
        threads = self.request.threads
        of_wide = max(1, threads // LONG_MEASURES)

        def work(piece):
            progress.begin(piece.name)
            self.make(piece, of_wide if piece.wide else 1)
            progress(piece.name)

        todo.sort(key=lambda piece: not piece.wide)
        # A piece made of another one waits for it.
        for layer in (lambda one: not one.source, lambda one: one.source and (self.folder / one.source).exists()):
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                waiting = [pool.submit(work, one) for one in todo if layer(one)]
                try:
                    for done in waiting:
                        done.result()
                except BaseException:  # stopped: the others do not begin
                    pool.shutdown(wait=False, cancel_futures=True)
                    self.stop()
                    raise

    def summary(self, name):
        return Steps.read(self.folder / f"{name}.json") if self.has(name) else None

    def has(self, name):
        return name in self.made or name in self.reused


def described_tools(folder):
    """Name -> what the tool says of itself, of all that stand in a folder of executables."""
    path = folder / "tools.json"
    try:
        return {tool["name"]: tool for tool in json.loads(path.read_text())}
    except (OSError, ValueError, TypeError, KeyError):
        raise InvalidInput(f"the list of the tools is not at '{path}'; build all of tomodem, or install it") from None


QUICK_MEASURES = ("stress_strain", "equilibrium", "shape_factor")


def measures(run, tools, frames, quick):
    """A table of each measure that is among the tools: those known here that the run has the curves, frames or objects for,
    in this order, with their tables of details; then every other one. And name -> reason of those left out.

    @param frames  those that the measures which can look at single frames (--frames) measure; the others measure all
    """
    def lacks(*curves):
        missing = [name for name in curves if name not in run.curves]
        if not run.curves:
            return "the file is a sample, without curves"
        return f"the run has no curve {' and '.join(missing)}" if missing else ""

    no_objects = "" if run.objects else "the sample has no objects"
    # What keeps each from being made.
    known = {
        "stress_strain": lacks("strain", "stress_true", "stress_engineering", "equilibrium_error"),
        "equilibrium": lacks("strain", "force_top", "force_bottom"),
        "relative_density": "",
        "volume_change": "" if run.frame_count > 1 else "there is one frame",
        "shape_factor": no_objects,
        "object_shapes": no_objects,
        "topology": "",
        # Its pores are one, and what it holds is one minus the relative density; a lid over it takes long.
        "pores": "the structure is open, one pore with mouths all around: see its relative density" if run.is_open else "",
        "coordination": "",
        "crystallinity": "",
        "control_numbers": lacks("kinetic_energy", "potential_energy", "force_top")
        or ("" if run.provenance.scene else "the file does not hold a scene"),
    }
    words = {
        "equilibrium": ("--from", f"{2 / 3 * run.largest_strain:.6g}"),
        "shape_factor": ("--means", "shape_factor_means.csv"),
        "topology": ("--events", "topology_events.csv"),
        "pores": ("--each", "pores_each.csv"),
    }
    shown = [name for name, tool in tools.items() if tool["display"]]
    left_out, found = {}, []
    for name in [*(name for name in known if name in shown), *sorted(name for name in shown if name not in known)]:
        why = known.get(name) or ("left out by --quick" if quick and name not in QUICK_MEASURES else "")
        if why:
            left_out[name] = why
            continue
        if len(frames) < run.frame_count and any(one["name"] == "--frames" for one in tools[name]["arguments"]):
            words[name] = (*words.get(name, ()), "--frames", ",".join(map(str, frames)))
        tables = (f"{name}.csv", *(word for word in words.get(name, ()) if word.endswith(".csv")))
        found.append(Piece(name, name, words.get(name, ()), tables, wide=tools[name]["threads"],
                           optional=name not in known and not run.curves))
    return found, left_out


def pictures(run, size, quick):
    """Of the first frame and of the last one, drawn by one process: cut open, the inclusions, the pores of one phase alone, their
    surface; at the end what the run says of each particle."""
    inclusions = sorted(run.species_of_objects) or [label for label in run.species if label != run.matrix]
    shown = inclusions[0] if inclusions else run.matrix
    moments = {"before": "first", "after": "last"} if run.frame_count > 1 else {"before": "first"}
    press = ("--press", run.load_axis) if run.load_axis else ()
    found = []

    def picture(what, *words, moments=moments):
        frames = ("--frames", ",".join(moments.values()), "--names", ",".join(moments))
        files = tuple(f"picture_{what}_{when}.png" for when in moments)
        found.append(Piece(f"picture_{what}", "render", (*words, *frames, "--size", size), files, output=f"picture_{what}.png",
                           kept_with=(size,)))

    picture("cut", "--cut", "auto", *press)
    if quick:
        return found
    picture("inclusions", "--only-species", str(shown), "--color", "object" if run.objects else "phase")
    if not inclusions:
        picture("pores", "--pores")
    for when, frame in moments.items():
        frame = "0" if frame == "first" else "-1"
        found.append(Piece(f"mesh_{when}", "mesh_recon", ("--frame", frame, "--species", str(shown)), (f"mesh_{when}.stl",)))
        found.append(Piece(f"picture_mesh_{when}", "render", ("--view-of", str(run.path), "--size", size),
                           (f"picture_mesh_{when}.png",), source=f"mesh_{when}.stl", kept_with=(size,)))
    if "after" in moments:
        if "stress" in run.fields and run.load_axis:
            picture("stress", "--color", f"stress_{2 * run.load_axis}", "--cut", "auto", *press, moments={"after": "last"})
        if "outward" in run.fields:
            picture("outward", "--slice", "y", "--arrows", "outward", moments={"after": "last"})
    return found


def surfaces(run, frames):
    """What the 3-D view is made of: the surface of the sample, of its inclusions and of its pores in each of the frames."""
    found = []
    for frame in frames:
        def surface(what, *words, frame=frame):
            name = f"view/{what}_{frame:04d}"
            found.append(Piece(name, "mesh_recon", ("--frame", str(frame), *words), (f"{name}.vtp",)))

        surface("sample")
        if run.objects:
            surface("objects", "--each-object")
        for label in run.species:
            if label != run.matrix and label not in run.species_of_objects:
                surface(f"phase{label}", "--species", str(label))
        surface("pores", "--pores")
    return found
