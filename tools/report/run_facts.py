"""What a page needs to know of a run or a sample before anything is measured."""
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import shlex
import tomllib

import h5py
import numpy as np

from command_line import InvalidInput


@dataclasses.dataclass(frozen=True)
class Provenance:
    tool: str
    version: str
    command_line: str
    scene: str
    inputs: dict  # name -> SHA-256 of its content, as hexadecimal digits


def real_paths(words, folder):
    """What relative paths mean here, and what they mean in the folder."""
    return {os.path.realpath(os.path.join(base, word)) for word in words for base in (".", folder)}


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def provenance_of(file):
    group = file.get("parameters/tomodem")
    if group is None:
        return Provenance("", "", "", "", {})

    def text(name):
        return text_of(group[name][()]) if name in group else ""

    names, digests = (map(text_of, group[f"inputs/{one}"][()] if f"inputs/{one}" in group else ()) for one in ("name", "sha256"))
    return Provenance(text("tool"), text("version"), text("command_line"), text("scene"), dict(zip(names, digests)))


def is_content_of(path, digest):
    """Whether a file is still the one of that SHA-256."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest() == digest


class RunFacts:
    """Everything but the positions of all frames, read once.

    @throws InvalidInput if the file is no H5MD file of particles
    """

    def __init__(self, path):
        self.path = path
        try:
            with h5py.File(path) as file:
                self.read(file)
        except (OSError, KeyError, ValueError, AttributeError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise InvalidInput(f"cannot read '{path}': it is no run or sample ({reason})") from None

    def read(self, file):
        particles = file["particles/all"]
        position = particles["position"]
        value = position["value"]
        times = position["time"][()]
        # What a solver was stopped in, or is still writing, is marked by a step below zero.
        steps = position["step"][()]
        self.frame_count = int(np.count_nonzero(steps >= 0)) if len(steps) == len(value) else len(value)
        self.frames_to_come = len(value) - self.frame_count
        if self.frame_count == 0 or value.shape[1] == 0:
            raise ValueError("it has no frame with particles")
        self.frame_time = np.asarray(times[: self.frame_count], float)
        self.particles = value.shape[1]
        self.seed_radius = float(particles.attrs["seed_radius"])
        self.species = dict(zip(*(column.tolist() for column in np.unique(particles["species"][()], return_counts=True))))
        self.objects = 0
        self.species_of_objects = set()
        if "object" in particles:
            number, species = particles["object"][()], particles["species"][()]
            self.objects = int(len(np.unique(number[number > 0])))
            self.species_of_objects = set(species[number > 0].tolist())
        self.extent = [np.array([one.min(axis=0), one.max(axis=0)]) for one in (value[0], value[self.frame_count - 1])]
        self.fields = {name for name, one in particles.items() if isinstance(one, h5py.Group) and "value" in one}
        self.curves = {
            name: (one["time"][()][one["step"][()] >= 0], one["value"][()][one["step"][()] >= 0])
            for name, one in file.get("observables", {}).items()
            if isinstance(one, h5py.Group) and {"value", "step", "time"} <= one.keys() and np.any(one["step"][()] >= 0)
        }
        self.provenance = provenance_of(file)

    @functools.cached_property
    def is_open(self):
        """Whether more than half of the box around the particles is void; in solid, spheres fill two thirds of the space."""
        low, high = self.extent[0]
        spheres = 4 / 3 * np.pi * self.seed_radius**3 * self.particles
        return bool(spheres < 0.33 * np.prod(high - low + 2 * self.seed_radius))

    @functools.cached_property
    def frame_strain(self):
        """True strain of each frame; not a number where the file has no such curve."""
        if "strain" not in self.curves:
            return np.full(self.frame_count, np.nan)
        time, strain = self.curves["strain"]
        known = np.isfinite(strain)
        if not np.any(known):
            return np.full(self.frame_count, np.nan)
        return np.interp(self.frame_time, time[known], strain[known])

    @functools.cached_property
    def largest_strain(self):
        """Largest |true strain| on the way; 0 where the file has no such curve."""
        strain = self.curves.get("strain", (None, np.zeros(1)))[1]
        return float(np.max(np.abs(strain[np.isfinite(strain)]), initial=0))

    @functools.cached_property
    def unfinished(self):
        """What says that the run has not reached its end, as part of a sentence; empty if nothing does.

        While solve works, or when it was stopped, the run is NAME.h5.partial, and what is to come is marked in it.
        """
        if self.path.suffix != ".partial" and self.frames_to_come == 0:
            return ""
        frames = f"{self.frame_count} of {self.frame_count + self.frames_to_come} frames" if self.frames_to_come else \
            f"{self.frame_count} frames"
        reached, steps = self.frame_strain[-1], self.scene.get("load", {}).get("steps", [])
        target = steps[-1].get("strain") if steps and isinstance(steps[-1], dict) else None
        if np.isfinite(reached) and isinstance(target, (int, float)):
            return f"it has {frames} and reached a true strain of {reached:.3f} of {target:g}"
        return f"it has {frames}"

    @property
    def checkpoint(self):
        """Of an unfinished run: whether its checkpoint, from which solve --resume goes on, stands beside it."""
        return self.path.with_suffix(".checkpoint").is_file()

    @functools.cached_property
    def scene(self):
        try:
            return tomllib.loads(self.provenance.scene)
        except tomllib.TOMLDecodeError:
            return {}

    @property
    def matrix(self):
        """Label of the phase with most particles."""
        return max(self.species, key=lambda label: self.species[label])

    @functools.cached_property
    def names(self):
        """Label -> name of the phase, as far as the scene says."""
        return {phase["label"]: name for name, phase in self.scene.get("phase", {}).items() if "label" in phase}

    @property
    def unit(self):
        """In which small places and volumes are read well: its name, and how many of it are a millimetre."""
        return ("mm", 1) if self.seed_radius >= 0.05 else ("µm", 1000)

    @property
    def load_axis(self):
        """Across which the press planes are; empty where there are none."""
        axis = self.scene.get("load", {}).get("axis", "z")
        return axis if "force_top" in self.curves and axis in ("x", "y", "z") else ""


class Steps:
    """The summaries (--json) of the tools that made a run, and of those that measured it, found in some folders.

    A summary belongs to a run if its command wrote the run, an input of such a command, or read one of these. Commands are
    known by what the files themselves say of their making, so what is left of an earlier run stays out.
    """

    ORDER = ("phantom_", "volume_info", "grey_histogram", "packgen", "vol2pack", "carve", "relax", "solve")

    def __init__(self, run, folders):
        summaries = {}
        for folder in dict.fromkeys(one.resolve() for one in folders):
            for path in sorted(folder.glob("*.json")):
                summary = self.read(path)
                if summary is not None and summary["tool"] != "report":
                    # A run may be named as a measure is.
                    name = path.stem if path.stem not in summaries else f"{path.stem} beside the run"
                    summaries[name] = summary
        commands, files = self.history(run)
        self.of_run = {}
        for name, one in sorted(summaries.items(), key=lambda item: self.place(item[1])):
            words = shlex.split(one["command_line"])
            if one["command_line"] in commands or files.intersection(real_paths(words[1:2], run.path.parent)):
                self.of_run[name] = one
                # What is drawn of a mesh of this run is a picture of this run.
                if one["tool"] == "mesh_recon":
                    files |= real_paths(words[2:3], run.path.parent)

    @staticmethod
    def read(path):
        try:
            summary = json.loads(path.read_text())
        except (OSError, ValueError):
            return None
        wanted = ("tool", "command_line", "wall_seconds", "cpu_seconds", "peak_bytes")
        return summary if isinstance(summary, dict) and all(key in summary for key in wanted) else None

    @staticmethod
    def place(summary):
        for place, tool in enumerate(Steps.ORDER):
            if summary["tool"].startswith(tool):
                return place
        return len(Steps.ORDER) + {"mesh_recon": 1, "render": 2}.get(summary["tool"], 0)

    @staticmethod
    def origins(run):
        """What the run and the files that it was made from say of their making, as far as these are still there, the run first.

        A file of that name that has been made anew since is none of them.
        """
        todo, seen = [run.provenance], set()
        while todo:
            provenance = todo.pop()
            yield provenance
            for name, digest in provenance.inputs.items():
                if name in seen:
                    continue
                seen.add(name)
                for place in (name, run.path.parent / pathlib.PurePath(name).name):
                    try:
                        with h5py.File(place) as file:
                            before = provenance_of(file)
                        if before.tool and is_content_of(place, digest):
                            todo.append(before)
                            break
                    except OSError:
                        continue

    @staticmethod
    def history(run):
        """Command lines that made a run and its inputs; the run and the images it comes from."""
        commands, files = set(), {os.path.realpath(run.path)}
        for provenance in Steps.origins(run):
            commands.add(provenance.command_line)
            # Not the brick beside it, which samples of other images may share.
            if provenance.tool == "vol2pack":
                files |= real_paths(shlex.split(provenance.command_line)[2:3], run.path.parent)
        return commands - {""}, files

    @staticmethod
    def image_of(run):
        """The image that the run or sample was made from, as the command line of vol2pack named it; empty if not known."""
        for provenance in Steps.origins(run):
            words = shlex.split(provenance.command_line)
            if provenance.tool == "vol2pack" and len(words) > 3:
                return words[2]
        return ""

    def first(self, tool):
        """The summary of the first step by this tool (or whose name begins so), or nothing."""
        return next((one for one in self.of_run.values() if one["tool"].startswith(tool)), None)
