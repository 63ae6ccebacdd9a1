"""The page: what the pieces say, as values for the templates.

A part whose pieces are not there, or do not hold what it needs, is a sentence in its place that says why; no part takes another
one with it.
"""
import base64
import json
import pathlib
import traceback

import numpy as np

import plots
from command_line import InvalidInput
from run_facts import Steps
from templates import as_it_is, filled, own_text
from words import (count, fixed, length, mebibytes, number, object_colour, percent, phase_colours, plural, quantity, read_table,
                   seconds)

THREE = pathlib.Path("/usr/share/javascript/three/three.min.js")  # Debian's libjs-three
MOST_ROWS = 5000
# Names that say nothing of a sample: that of the folder they are in does.
GENERIC_NAMES = {"binary", "grey", "image", "images", "label", "labels", "mask", "raw", "segmentation", "segmented", "slices",
                 "stack", "volume"}

PICTURES = {
    "cut": "The sample cut open where most of its inclusions or pores lie",
    "inclusions": "The inclusions alone",
    "mesh": "Their surface, rebuilt from the particles",
    "pores": "Closed pores in the translucent sample",
    "stress": "Stress along the load of each particle, mean over the window before the frame",
    "outward": "A layer of one diameter, with the outward vectors",
}
EVENTS = {
    "merge": "parts merged", "split": "part split", "part_appeared": "part appeared", "part_vanished": "part vanished",
    "coalescence": "pores coalesced", "pore_split": "pore split", "pore_opened": "pore opened", "pore_closed": "pore closed",
    "pore_breached": "pore found a way out", "pore_sealed": "pore sealed off",
}


def table(head, rows, words=(), total=False, frames=()):
    """As the template `table` takes it."""
    return {"head": head, "rows": rows, "words": words, "total": total, "frames": frames}


def swatch(colour, text):
    return {"swatch": colour, "text": text, "soft": ""}


def strain_text(strain):
    return f"true strain {fixed(strain, 3)}" if np.isfinite(strain) else ""


def sample_name(image):
    """What an image is called: its file or folder without extension, data set and pattern, or the folder of a file whose name
    says nothing."""
    path = pathlib.PurePath(image.partition(":/")[0])
    names = [part for part in (path.stem, *path.parent.parts[::-1]) if part.strip("./") and not set("*?[") & set(part)]
    return next((name for name in names[:2] if name.lower() not in GENERIC_NAMES), names[0] if names else "")


def known(value, digits):
    return fixed(value, digits) if np.isfinite(value) else ""


def rest(all_rows, file):
    """What is said below a table that does not hold all rows."""
    return f"The first {count(MOST_ROWS)} of {count(int(all_rows))}; the others are in {file}." if all_rows > MOST_ROWS else ""


class Missing(Exception):
    """Why a part of the page is not there, as a sentence."""


class Found(dict):
    """A summary or a table. What it does not hold makes the part that needs it a sentence."""

    def __init__(self, source, values):
        super().__init__(values)
        self.source = source

    def __missing__(self, key):
        raise Missing(f"Not shown: {self.source} does not hold '{key}'.")


class Page:
    """@param steps     Steps of the run: what its making and measuring cost
    @param displays  measure -> how it is shown, of those that were made, in their order
    @param headings  of the measures that were not made
    @param left_out  measure -> why it was not made
    @param title     the name of the sample, where it is not that of its image
    """

    def __init__(self, run, shop, steps, displays, headings, left_out, view, title):
        self.run, self.shop, self.view, self.title = run, shop, view, title
        self.displays, self.headings, self.left_out = displays, headings, left_out
        self.absent, self.faults = {}, []
        self.steps = {name: Found(f"the summary {name}.json", one) for name, one in steps.of_run.items()}
        self.sample = self.first_step("vol2pack")
        self.image = self.first_step("volume_info")
        self.phantom = self.first_step("phantom_")
        self.solved = next(
            (one for one in self.steps.values() if one["command_line"] == run.provenance.command_line), {})
        self.summary = {name: Found(f"the summary of {name}", shop.summary(name)) for name in displays}
        self.tables = {}
        for measure, details in [(name, name) for name in displays] + [
                ("shape_factor", "shape_factor_means"), ("pores", "pores_each"), ("topology", "topology_events")]:
            if measure in displays:
                self.part(f"table {details}", self.read, details)
        self.events = self.part("events", self.read_events) or []

    def first_step(self, tool):
        return next((one for one in self.steps.values() if one["tool"].startswith(tool)), None)

    def read(self, name):
        path = self.shop.folder / f"{name}.csv"
        try:
            self.tables[name] = Found(f"{name}.csv", read_table(path))
        except (OSError, ValueError) as error:
            raise Missing(f"Not shown: {name}.csv cannot be read: {error}.") from None

    def part(self, what, make, *arguments):
        """What `make` returns. If it cannot, why is in `absent`; the page goes on."""
        try:
            return make(*arguments)
        except Missing as why:
            self.absent[what] = str(why)
        except InvalidInput:
            raise
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            fault = f"{type(error).__name__}: {error} ({pathlib.Path(place.filename).name}:{place.lineno})"
            self.absent[what] = f"Not shown, by a fault of this program: {fault}."
            self.faults.append(f"Without {what}, by a fault of this program: {fault}")
        return None

    def table_of(self, measure, details):
        """The table of a measure, or why it is not there."""
        if details in self.tables:
            return self.tables[details]
        for why in (self.absent.get(f"table {details}"), self.why_not(measure)):
            if why:
                raise Missing(why)
        raise Missing(f"Not shown: {measure} was not measured.")

    def why_not(self, measure):
        reason = self.shop.failed.get(measure) or self.left_out.get(measure)
        return f"Not shown: {reason.rstrip('.')}." if reason else ""

    # ---- what is known ---------------------------------------------------------------------------------------------
    def name(self):
        if self.title:
            return self.title
        if self.phantom:
            kind = self.phantom["tool"].removeprefix("phantom_")
            return {"inclusions": "Phantom composite", "pores": "Phantom casting", "foam": "Phantom foam"}.get(kind, "Phantom")
        words = self.image["command_line"].split() if self.image else []
        image = words[1] if len(words) > 1 else Steps.image_of(self.run)
        return sample_name(image) or self.run.path.name.partition(".")[0]

    def phase_name(self, label, given=""):
        return self.run.names.get(label, given or f"label {label}")

    def time_of_steps(self):
        return sum(one["wall_seconds"] for one in self.steps.values())

    def read_events(self):
        """One dictionary a row, of those that happened nearest to a frame of the view."""
        columns = self.tables.get("topology_events")
        if columns is None or not len(columns["event"]):
            return []
        frames = np.array(self.view["frames"] or [0])
        return [
            {
                "name": EVENTS.get(kind, kind), "kind": kind,
                # The first frame shown in which it has happened.
                "view_frame": int(min(np.searchsorted(frames, columns["frame"][k]), len(frames) - 1)),
                "frame": int(columns["frame"][k]),
                "place": [float(columns[axis][k]) for axis in "xyz"],
                "strain_before": columns["strain_before"][k], "strain": columns["strain"][k],
                "volume": columns["volume"][k],
            }
            for k, kind in enumerate(columns["event"])
        ]

    # ---- sections ----------------------------------------------------------------------------------------------------
    def facts(self):
        run, parts = self.run, []
        if self.image and all(f"{what}_{axis}" in self.image for what in ("size", "extent") for axis in "xyz"):
            size = " × ".join(str(self.image[f"size_{axis}"]) for axis in "xyz")
            extent = " × ".join(number(self.image[f"extent_{axis}"]) for axis in "xyz")
            parts.append(f"{size} voxels, {extent} mm")
        else:
            low, high = run.extent[0]
            parts.append(" × ".join(length(edge) for edge in high - low + 2 * run.seed_radius))
        parts.append(f"{plural(run.particles, 'particle')} of radius {length(run.seed_radius)}")
        if len(run.species) > 1:
            parts.append(", ".join(self.phase_name(label) for label in sorted(run.species)))
        return [*parts, plural(run.frame_count, "frame")]

    def results(self, name):
        """(label, value with unit) of the results that the summary of a measure has, as it declares them."""
        found, summary = [], self.summary[name]
        for one in self.displays[name]["results"]:
            value = summary.get(one["key"])
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                continue
            if f"{one['key']}_unreliable" in summary:  # said once, as what it is
                continue
            found.append((one["label"], quantity(value if one["factor"] == 1 else one["factor"] * value, one["unit"])))
        return found

    def key_figures(self):
        """The first result of each measure."""
        figures = []
        if np.isfinite(self.run.frame_strain[-1]) and self.run.frame_count > 1:
            figures.append((number(self.run.frame_strain[-1]), "true strain reached"))
        if "final_stress" in self.solved and "flow_stress" not in (self.summary.get("stress_strain") or {}):
            figures.append((f"{abs(self.solved['final_stress']) / 1e6:.1f} MPa", "stress at the end"))
        for name in self.displays:
            for label, value in self.results(name)[:1]:
                if name == "stress_strain":
                    label += self.flow_strain()
                if (value, label) not in figures:
                    figures.append((value, label))
        if self.solved or self.sample:
            figures.append((seconds(self.time_of_steps()), "from image to measures" if self.sample else "all steps"))
        return figures

    def flow_strain(self):
        """Where the flow stress was measured, as the end of its name."""
        ends = [self.summary["stress_strain"].get(f"flow_abs_strain_{end}") for end in ("from", "to")]
        return f" at |strain| {number(ends[0])} to {number(ends[1])}" if all(isinstance(one, float) for one in ends) else ""

    def warnings(self):
        """What makes a result doubtful, in words; also printed when the report is made."""
        found = []
        if self.run.unfinished:
            more = "; solve --resume goes on from the checkpoint beside it" if self.run.checkpoint else ""
            found.append(f"Unfinished run: {self.run.unfinished}. Every figure is of what there is{more}.")
        if one := self.summary.get("equilibrium"):
            if one.get("equilibrium_error", 0) > 0.05:
                found.append(f"The two planes differ by {percent(one['equilibrium_error'], 1)} of their force: inertia or too "
                             "few particles carry the load. Take a smaller strain_per_step, or smaller particles.")
        if one := self.summary.get("volume_change"):
            if abs(one.get("volume_change_last", 0)) > 0.1:
                found.append(f"The volume of the envelope changed by {percent(one['volume_change_last'], 1)}: parts that are "
                             "only a few particles thick clump, or come apart. Take smaller particles (--pixels-per-seed; "
                             "PIXELS_PER_SEED in the pipelines) until the result no longer changes.")
        if (one := self.summary.get("stress_strain") or {}).get("stress_reliable") == "no":
            across, wanted = one.get("particles_across"), one.get("particles_that_would_do")
            found.append("The flow stress is unreliable: " + "; ".join(filter(None, (
                f"the planes differ by {percent(one['plane_force_difference'], 1)} of their force"
                if one.get("plane_force_difference", 0) > 0.1 else "",
                f"the parts of the solid are {number(across)} particles across, and some {count(round(wanted))} particles would do"
                if across and wanted else ""))) + ".")
        if self.solved.get("particles_lost", 0) > 0:
            found.append(f"{plural(self.solved['particles_lost'], 'particle')} were lost.")
        by_reason = {}
        for name, reason in self.shop.failed.items():
            by_reason.setdefault(reason, []).append(name)
        for reason, names in by_reason.items():
            more = f" and {len(names) - 1} more" if len(names) > 1 else ""
            found.append(f"Without {names[0]}{more}: {reason}")
        return [*found, *self.faults]

    def viewer(self):
        run, view = self.run, self.view
        if not view["layers"]:
            reasons = [reason for name, reason in self.shop.failed.items() if name.startswith("view/")]
            raise Missing(f"Not shown: {view['left_out'] or next(iter(reasons), 'no surface could be made').rstrip('.')}.")
        if not THREE.exists():
            raise InvalidInput(f"cannot read '{THREE}', which draws the view; install the Debian package libjs-three")
        data = {
            **{key: view[key] for key in ("frames", "layers", "bounds")},
            "start": 0,
            "last": run.frame_count - 1,
            "opacity": 0.3 if len(view["layers"]) > 1 else 1,
            "box": [(run.extent[0][0] - run.seed_radius).tolist(), (run.extent[0][1] + run.seed_radius).tolist()],
            "captions": [strain_text(run.frame_strain[frame]) for frame in view["frames"]],
            "events": [{"frame": one["view_frame"], "place": one["place"], "name": one["name"]} for one in self.events
                       if all(np.isfinite(one["place"]))],
        }
        every = "" if len(view["frames"]) == run.frame_count else \
            f"{len(view['frames'])} of {run.frame_count} frames: {', '.join(map(str, view['frames']))}. "
        every += "".join(f"{note} " for note in view["notes"])
        return {
            "note": f"{every}Surfaces through the centres of the outermost particles, {count(view['triangles'])} triangles after "
                    "coarsening for this page.",
            "frame": as_it_is(own_text("viewer.html")),
            # Nothing in it can end the script that holds it.
            "data": as_it_is(json.dumps(data, allow_nan=False).replace("</", "<\\/")),
            "three": as_it_is(THREE.read_text(encoding="utf-8")),
            "script": as_it_is(own_text("viewer.js")),
        }

    def pictures(self):
        pictures = []
        several = len(self.run.species) > 1
        for what, caption in PICTURES.items():
            if what == "inclusions" and not several:
                caption = "The whole sample"
            if what == "mesh" and not several:
                caption = "Its surface, rebuilt from the particles"
            for when in ("before", "after"):
                full = f"{caption}, {when}" if self.run.frame_count > 1 else caption
                pieces = [one for one in (f"picture_{what}", f"picture_{what}_{when}", f"{what}_{when}")
                          if self.shop.has(one) or one in self.shop.failed]
                file = self.shop.folder / f"picture_{what}_{when}.png"
                if pieces and self.shop.has(pieces[0]) and file.is_file():
                    data = base64.b64encode(file.read_bytes()).decode()
                    pictures.append({"data": data, "caption": full + self.place_of_cut(pieces[0])})
                elif reason := next((self.shop.failed[one] for one in pieces if one in self.shop.failed), ""):
                    pictures.append({"data": "", "caption": f"{full}: not drawn. {reason}"})
        if not pictures:
            raise Missing("Not shown: no picture was made.")
        return pictures

    def place_of_cut(self, picture):
        place = self.shop.summary(picture).get("cut")
        return f" ({place})" if isinstance(place, str) else ""

    def shares_of_dense_phases(self):
        """Label -> share of the sample, or nothing if it is porous or of one phase."""
        shares = {one.get("label"): one.get("sample_fraction", 0) for one in (self.sample or {}).get("phases", ())
                  if one.get("label") != 0}
        return shares if len(shares) > 1 and sum(shares.values()) > 0.99 else {}

    def measures(self):
        more = {"scene": self.run.scene, "shares": self.shares_of_dense_phases(), "means": self.tables.get("shape_factor_means")}
        return [{"name": name, "heading": display["heading"], "results": self.results(name),
                 **self.drawing(name, display, more), "frames": self.frames_measured(name)}
                for name, display in self.displays.items()]

    def drawing(self, name, display, more):
        """The plot, and in the place of one that cannot be drawn why."""
        part = f"the plot of {name}"
        drawn = self.part(part, lambda: plots.measure(name, display, self.table_of(name, name), more))
        if drawn:
            return {"drawing": as_it_is(drawn), "why": ""}
        flat = "Not drawn: it is measured at one moment, or does not change." if display["x"] else ""
        return {"drawing": "", "why": self.absent.get(part, flat)}

    def frames_measured(self, name):
        """Which frames, where they are not all."""
        column = self.tables.get(name, {}).get("frame")
        frames = sorted({int(one) for one in column}) if plots.numeric(column) else ()
        return f"Measured in {len(frames)} of {self.run.frame_count} frames: {', '.join(map(str, frames))}." \
            if 0 < len(frames) < self.run.frame_count else ""

    def not_measured(self):
        """One line for each reason."""
        by_reason = {}
        for name, reason in self.left_out.items():
            by_reason.setdefault(reason, []).append(self.headings[name])
        return [f"{', '.join(names)}: {reason}." for reason, names in by_reason.items()]

    def events_of_topology(self):
        if self.run.frame_count < 2:
            raise Missing("Not shown: there is one frame, and events are found between frames.")
        self.table_of("topology", "topology_events")
        if "events" in self.absent:
            raise Missing(self.absent["events"])
        shown = self.events[:MOST_ROWS]
        if not shown:
            return {"none": self.no_event(), "table": None}
        unit, factor = self.run.unit
        rows = [
            (one["name"], f"{fixed(one['strain_before'], 3)} to {fixed(one['strain'], 3)}", one["frame"],
             ", ".join(number(factor * value, 4) for value in one["place"]), number(factor**3 * one["volume"]))
            for one in shown
        ]
        head = ["event", "true strain", "seen in frame", f"place x, y, z [{unit}]", f"volume [{unit}³]"]
        return {
            "none": "", "title": plural(len(self.events), "event"), "all": count(len(self.events)), "rest": len(self.events) > len(shown),
            "table": table(head, rows, frames=[one["view_frame"] for one in shown] if self.view["frames"] else ()),
        }

    def no_event(self):
        """The sentence without events, which must not deny what the numbers of parts and pores say."""
        changed = []
        for measure, key, name in (("topology", "b0", "separate parts"), ("topology", "b1", "handles"),
                                   ("topology", "b2", "closed pores"), ("pores", "pores", "pores, those with a mouth included")):
            numbers = self.tables.get(measure, {}).get(key)
            if plots.numeric(numbers) and len(numbers := numbers[np.isfinite(numbers)]) and min(numbers) != max(numbers):
                way = "" if {numbers[0], numbers[-1]} >= {min(numbers), max(numbers)} else \
                    f" ({count(int(min(numbers)))} to {count(int(max(numbers)))} on the way)"
                changed.append(f"{name} {count(int(numbers[0]))} → {count(int(numbers[-1]))}{way}")
        if not changed:
            return "Nothing merged, split, opened or closed on the way, the whole sample taken as one material."
        return ("No part and no closed pore that is large enough to be followed from frame to frame merged, split, opened or closed. "
                f"The numbers that count smaller ones too changed: {'; '.join(changed)}.")

    def phases(self):
        colours = phase_colours(self.run.species, self.run.matrix)
        if self.sample and "phases" in self.sample:
            rows = []
            for phase in (Found("a phase in the summary of vol2pack", one) for one in self.sample["phases"]):
                label = phase["label"]
                if label == 0 and phase["image_fraction"] == 0:
                    continue
                difference = 100 * (phase["sample_fraction"] - phase["image_fraction"])
                sign = "+" * (difference > 0)
                rows.append((swatch(colours.get(label, ""), self.phase_name(label, phase["name"])),
                             percent(phase["image_fraction"]), percent(phase["sample_fraction"]),
                             f"{sign}{fixed(difference, 2)} points", count(phase["particles"]) if label else ""))
            return table(["phase", "image", "sample", "difference", "particles"], rows)
        rows = [
            (swatch(colours.get(label, ""), self.phase_name(label)), count(particles), percent(particles / self.run.particles))
            for label, particles in sorted(self.run.species.items())
        ]
        return table(["phase", "particles", "share of the particles"], rows)

    def checks(self):
        rows = []
        if self.sample and "particles" in self.sample:
            particles = self.sample["particles"]
            lost = particles - self.run.particles + self.solved.get("particles_lost", 0)
            rows.append(("particles lost", f"{lost} of {count(particles)}", "from the sample to the end of the run"))
        elif "particles_lost" in self.solved:
            rows.append(("particles lost", f"{self.solved['particles_lost']} of {count(self.run.particles)}", ""))
        if shape := self.summary.get("shape_factor"):
            said = [f"{shape[key]} {words}" for key, words in (
                ("objects_used", "measured"), ("objects_too_small", "too small"), ("objects_at_boundary", "left out at the outer faces"))
                if key in shape]
            if self.sample and "smallest_object" in self.sample:
                said.append(f"smallest has {self.sample['smallest_object']} particles")
            rows.append(("objects", str(self.run.objects), ", ".join(said)))
        return table(["check", "value", "how"], rows, words=(2,))

    def objects(self):
        if not self.run.objects:
            raise Missing("The sample has no objects (objects = true of a phase in the scene, or vol2pack --objects).")
        columns = self.table_of("shape_factor", "shape_factor")
        if not len(columns["object"]):
            small = self.summary["shape_factor"].get("objects_too_small", 0)
            raise Missing(f"None of the {self.run.objects} objects was measured"
                          f"{f': {small} are too small' if small else ''}.")
        unit, factor = self.run.unit
        first, last = (columns["frame"] == frame for frame in (min(columns["frame"]), max(columns["frame"])))
        before = dict(zip(columns["object"][first], columns["shape_factor"][first]))
        rows = []
        for k in np.flatnonzero(last)[:MOST_ROWS]:
            name = int(columns["object"][k])
            start = before.get(columns["object"][k], np.nan)
            rows.append((swatch(object_colour(name), str(name)), count(int(columns["particles"][k])),
                         number(factor**3 * columns["volume_estimate"][k]), known(start, 3),
                         known(columns["shape_factor"][k], 3), known(columns["shape_factor"][k] / start, 3)))
        head = ["object", "particles", f"volume, by its particles [{unit}³]", "shape factor before", "after", "after / before"]
        return {**table(head, rows), "rest": rest(np.count_nonzero(last), "shape_factor.csv")}

    def pores(self):
        columns = self.table_of("pores", "pores_each")
        measured = self.table_of("pores", "pores")["frame"]
        at = int(max(measured)) if len(measured) else 0
        here = np.flatnonzero(columns["frame"] == at) if len(columns["pore"]) else ()
        if not len(here):
            raise Missing(f"There is no pore in frame {at}.")
        unit, factor = self.run.unit
        rows = [(str(int(columns["pore"][k])), count(int(columns["particles"][k])),
                 number(factor**3 * columns["volume_corrected"][k]) if np.isfinite(columns["volume_corrected"][k]) else "",
                 known(columns["sphericity"][k], 3), "open" if columns["mouth_area"][k] > 0 else "closed",
                 ", ".join(number(factor * columns[f"centre_{axis}"][k], 4) for axis in "xyz")) for k in here[:MOST_ROWS]]
        head = ["pore", "particles around it", f"volume [{unit}³]", "sphericity", "", f"centre x, y, z [{unit}]"]
        return {**table(head, rows), "frame": at, "rest": rest(len(here), "pores_each.csv")}

    def costs(self):
        all_steps = {**self.steps, **self.view["costs"]}
        if not all_steps:
            raise Missing("Not known: the summaries (--json) of the steps are not in the folder of the run.")
        # The name distinguishes the runs of a tool that is used several times.
        rows = [
            ({"text": one["tool"], "soft": name.partition("_")[2].replace("_", " ") if one["tool"] in ("render", "mesh_recon") else "",
              "swatch": ""},
             seconds(one["wall_seconds"]), seconds(one["cpu_seconds"]), mebibytes(one["peak_bytes"]))
            for name, one in all_steps.items()
        ]
        rows.append(("all", seconds(sum(one["wall_seconds"] for one in all_steps.values())),
                     seconds(sum(one["cpu_seconds"] for one in all_steps.values())),
                     mebibytes(max(one["peak_bytes"] for one in all_steps.values()))))
        solved, notes = self.solved, []
        if {"steps", "time_step", "processes"} <= solved.keys():
            notes.append(f"{count(solved['steps'])} time steps of {number(solved['time_step'])} s on "
                         f"{solved['processes']} process{'es' * (solved['processes'] != 1)}")
        if "seconds_per_particle_step" in solved:
            notes.append(f"{1e6 * solved['seconds_per_particle_step']:.2f} µs of CPU time per particle and step")
        if "predicted_wall_seconds" in solved:
            notes.append(f"{seconds(solved['predicted_wall_seconds'])} were predicted")
        if not solved and self.run.provenance.tool == "solve":
            notes.append("What the run itself cost is not known: keep the summary of solve --json beside it")
        return {**table(["step", "time", "CPU time", "peak memory"], rows, total=True), "notes": notes}

    def commands(self):
        origin = self.run.provenance.command_line
        commands = [one["command_line"] for one in self.steps.values()]
        if origin and origin not in commands:
            commands.insert(0, origin)
        # A folder that was made for this page is gone by now; where it was says nothing.
        return [line.replace(f"{self.shop.folder}/", "") for line in commands]

    def text(self):
        origin = self.run.provenance
        parts = {name: self.part(name, make) for name, make in (
            ("facts", self.facts), ("key figures", self.key_figures), ("view", self.viewer), ("pictures", self.pictures),
            ("measures", self.measures), ("topology", self.events_of_topology), ("phases", self.phases), ("checks", self.checks),
            ("objects", self.objects), ("pores", self.pores), ("costs", self.costs), ("commands", self.commands))}
        titles = {"view": "3-D view", "topology": "events"}
        sections = ("view", "pictures", "measures", "topology", "errors", "costs", "scene", "commands")
        return filled(
            "page.html", name=self.name(), style=as_it_is(own_text("page.css")),
            sections=[(anchor, titles.get(anchor, anchor)) for anchor in sections], parts=parts, absent=self.absent,
            unfinished=bool(self.run.unfinished), warnings=self.warnings(), moved=self.run.frame_count > 1,
            not_measured=self.not_measured(), scene=origin.scene, version=origin.version, run=self.run.path.name,
            xdmf=self.run.path.with_suffix(".xdmf").name)
