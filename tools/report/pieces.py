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


@dataclasses.dataclass(frozen=True)
class Piece:
    name: str  # of its summary, NAME.json
    tool: str
    words: tuple  # of the command line, after the run
    files: tuple  # names of what it makes, the output of the command first
    source: str = ""  # another piece's file in the place of the run
    wide: bool = False  # a measure that works on all threads alone
    optional: bool = False  # nothing is said where it cannot be made


class Workshop:
    def __init__(self, run, folder, tools_folder, tools, request):
        self.run, self.folder, self.tools_folder, self.tools, self.request = run, folder, tools_folder, tools, request
        self.made, self.reused, self.failed = [], [], {}
        self.children, self.lock = set(), threading.Lock()
        (folder / "view").mkdir(parents=True, exist_ok=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
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
        return os.path.realpath(source) in real_paths(words[1:2], self.run.path.parent)

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
        command = [self.executable(piece.tool), source, outputs[piece.files[0]], *words, "--quiet",
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
        elif not piece.optional:
            line = complaint.strip().splitlines()[-1:] or [f"{piece.tool}: ended with status {child.returncode}"]
            self.failed[piece.name] = line[0]

    def make_all(self, pieces, progress):
        """Those for whole runs one after the other on all threads, then the others beside each other.

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
        threads = self.request.threads
        for piece in [one for one in todo if one.wide]:
            self.make(piece, threads)
            progress(piece.name)
        # A piece made of another one waits for it.
        for layer in (lambda one: not one.source, lambda one: one.source):
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                waiting = {
                    pool.submit(self.make, one, 1): one for one in todo
                    if not one.wide and layer(one) and (not one.source or (self.folder / one.source).exists())
                }
                for done in concurrent.futures.as_completed(waiting):
                    done.result()
                    progress(waiting[done].name)

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


def measures(run, tools):
    """A table of each measure that is among the tools: those known here that the run has the curves, frames or objects for,
    in this order, with their tables of details; then every other one."""
    largest = max((abs(strain) for strain in run.curves.get("strain", [0, [0]])[1]), default=0)
    known = {
        "stress_strain": {"strain", "stress_true", "stress_engineering", "equilibrium_error"} <= run.curves.keys(),
        "equilibrium": {"strain", "force_top", "force_bottom"} <= run.curves.keys(),
        "volume_change": run.frame_count > 1,
        "shape_factor": bool(run.objects),
        "object_shapes": bool(run.objects),
        "topology": True,
        "pores": True,
        "coordination": True,
        "crystallinity": True,
        "control_numbers": {"kinetic_energy", "potential_energy", "force_top"} <= run.curves.keys() and bool(run.provenance.scene),
    }
    words = {
        "equilibrium": ("--from", f"{2 / 3 * largest:.6g}"),
        "shape_factor": ("--means", "shape_factor_means.csv"),
        "topology": ("--events", "topology_events.csv"),
        "pores": ("--each", "pores_each.csv"),
    }
    shown = [name for name, tool in tools.items() if tool["display"]]
    others = sorted(name for name in shown if name not in known)
    return [
        Piece(name, name, words.get(name, ()), (f"{name}.csv", *(word for word in words.get(name, ()) if word.endswith(".csv"))),
              wide=tools[name]["threads"], optional=name not in known and not run.curves)
        for name in [*(name for name, possible in known.items() if possible and name in shown), *others]
    ]


def pictures(run, size):
    """Of the first frame and of the last one: cut open, the inclusions, their surface, the pores of one phase alone; at the end
    what the run says of each particle."""
    inclusions = sorted(run.species_of_objects) or [label for label in run.species if label != run.matrix]
    shown = inclusions[0] if inclusions else run.matrix
    frames = {"before": "0", "after": "-1"} if run.frame_count > 1 else {"before": "0"}
    press = ("--press", run.load_axis) if run.load_axis else ()
    found = []
    for when, frame in frames.items():
        def picture(what, words, when=when, frame=frame):
            name = f"picture_{what}_{when}"
            found.append(Piece(name, "render", ("--frame", frame, *words, "--size", size), (f"{name}.png",)))

        picture("cut", ("--cut", "y", *press))
        picture("inclusions", ("--only-species", str(shown), "--color", "object" if run.objects else "phase"))
        if not inclusions:
            picture("pores", ("--pores",))
        found.append(Piece(f"mesh_{when}", "mesh_recon", ("--frame", frame, "--species", str(shown)), (f"mesh_{when}.stl",)))
        found.append(Piece(f"picture_mesh_{when}", "render", ("--view-of", str(run.path), "--size", size),
                           (f"picture_mesh_{when}.png",), source=f"mesh_{when}.stl"))
        if when == "after" and "stress" in run.fields and run.load_axis:
            picture("stress", ("--color", f"stress_{2 * run.load_axis}", "--cut", "y", *press))
        if when == "after" and "outward" in run.fields:
            picture("outward", ("--slice", "y", "--arrows", "outward"))
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
