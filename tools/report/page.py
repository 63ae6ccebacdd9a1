"""The page: what the pieces say, as values for the templates; a section without its pieces is left out."""
import base64
import json
import pathlib

import numpy as np

import plots
from command_line import InvalidInput
from templates import as_it_is, filled, own_text
from words import (count, fixed, length, mebibytes, number, object_colour, percent, phase_colours, plural, quantity, read_table,
                   seconds)

THREE = pathlib.Path("/usr/share/javascript/three/three.min.js")  # Debian's libjs-three
MOST_ROWS = 200

PICTURES = {
    "cut": "The sample cut open in its middle",
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


class Page:
    """@param steps     Steps of the run: what its making and measuring cost
    @param displays  measure -> how it is shown, of those that were made, in their order
    """

    def __init__(self, run, shop, steps, displays, view):
        self.run, self.shop, self.displays, self.view = run, shop, displays, view
        self.steps = steps.of_run
        self.sample = steps.first("vol2pack")
        self.image = steps.first("volume_info")
        self.phantom = steps.first("phantom_")
        self.solved = next(
            (one for one in self.steps.values() if one["command_line"] == run.provenance.command_line), {})
        self.summary = {name: shop.summary(name) for name in displays}
        self.tables = {name: read_table(shop.folder / f"{name}.csv") for name in displays}
        for measure, details in (("shape_factor", "shape_factor_means"), ("pores", "pores_each"), ("topology", "topology_events")):
            if measure in displays:
                self.tables[details] = read_table(shop.folder / f"{details}.csv")
        self.events = self.read_events()

    # ---- what is known ---------------------------------------------------------------------------------------------
    def name(self):
        if self.phantom:
            kind = self.phantom["tool"].removeprefix("phantom_")
            return {"inclusions": "Phantom composite", "pores": "Phantom casting", "foam": "Phantom foam"}.get(kind, "Phantom")
        if self.image:
            words = self.image["command_line"].split()
            return "/".join(pathlib.PurePath(words[1]).parts[-2:]) if len(words) > 1 else "Image"
        return self.run.path.stem

    def phase_name(self, label, given=""):
        return self.run.names.get(label, given or f"label {label}")

    def time_of_steps(self):
        return sum(one["wall_seconds"] for one in self.steps.values())

    def read_events(self):
        """One dictionary a row, of those that happened nearest to a frame of the view."""
        columns = self.tables.get("topology_events")
        if columns is None or not len(columns["event"]):
            return []
        frames = np.array(self.view["frames"])
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
        if self.image:
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
            found.append((one["label"], quantity(value if one["factor"] == 1 else one["factor"] * value, one["unit"])))
        return found

    def key_figures(self):
        """The first result of each measure."""
        figures = []
        if "strain" in self.run.curves and self.run.frame_count > 1:
            figures.append((number(self.run.frame_strain[-1]), "true strain reached"))
        if "final_stress" in self.solved and "flow_stress" not in (self.summary.get("stress_strain") or {}):
            figures.append((f"{abs(self.solved['final_stress']) / 1e6:.1f} MPa", "stress at the end"))
        for results in map(self.results, self.displays):
            figures += [(value, label) for label, value in results[:1] if (value, label) not in figures]
        if self.solved or self.sample:
            figures.append((seconds(self.time_of_steps()), "from image to measures" if self.sample else "all steps"))
        return figures

    def warnings(self):
        """What makes a result doubtful, in words; also printed when the report is made."""
        found = []
        if one := self.summary.get("equilibrium"):
            if one["equilibrium_error"] > 0.05:
                found.append(f"The two planes differ by {percent(one['equilibrium_error'], 1)} of their force: inertia or too "
                             "few particles carry the load. Take a smaller strain_per_step, or smaller particles.")
        if one := self.summary.get("volume_change"):
            if abs(one["volume_change_last"]) > 0.1:
                found.append(f"The volume changed by {percent(one['volume_change_last'], 1)}: parts that are only a few "
                             "particles thick sinter into lumps. Take smaller particles (PIXELS_PER_SEED) until the result no "
                             "longer changes.")
        if self.solved.get("particles_lost", 0) > 0:
            found.append(f"{plural(self.solved['particles_lost'], 'particle')} were lost.")
        by_reason = {}
        for name, reason in self.shop.failed.items():
            by_reason.setdefault(reason, []).append(name)
        for reason, names in by_reason.items():
            more = f" and {len(names) - 1} more" if len(names) > 1 else ""
            found.append(f"Without {names[0]}{more}: {reason}")
        return found

    def viewer(self):
        run, view = self.run, self.view
        if not view["layers"]:
            return None
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
        every = "" if len(view["frames"]) == run.frame_count else f"{len(view['frames'])} of {run.frame_count} frames. "
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
            pictures += [
                {"data": base64.b64encode((self.shop.folder / f"picture_{what}_{when}.png").read_bytes()).decode(),
                 "caption": f"{caption}, {when}" if self.run.frame_count > 1 else caption}
                for when in ("before", "after") if self.shop.has(f"picture_{what}_{when}")
            ]
        return pictures

    def shares_of_dense_phases(self):
        """Label -> share of the sample, or nothing if it is porous or of one phase."""
        if not self.sample or "phases" not in self.sample:
            return {}
        shares = {one["label"]: one["sample_fraction"] for one in self.sample["phases"] if one["label"] != 0}
        return shares if len(shares) > 1 and sum(shares.values()) > 0.99 else {}

    def measures(self):
        more = {"scene": self.run.scene, "shares": self.shares_of_dense_phases(), "means": self.tables.get("shape_factor_means")}
        return [
            {"name": name, "heading": display["heading"], "results": self.results(name),
             "drawing": as_it_is(plots.measure(name, display, self.tables[name], more))}
            for name, display in self.displays.items()
        ]

    def events_of_topology(self):
        if "topology" not in self.displays or self.run.frame_count < 2:
            return None
        shown = self.events[:MOST_ROWS]
        unit, factor = self.run.unit
        rows = [
            (one["name"], f"{fixed(one['strain_before'], 3)} to {fixed(one['strain'], 3)}", one["frame"],
             ", ".join(number(factor * value, 4) for value in one["place"]), number(factor**3 * one["volume"]))
            for one in shown
        ]
        head = ["event", "true strain", "seen in frame", f"place x, y, z [{unit}]", f"volume [{unit}³]"]
        return rows and {
            "title": plural(len(self.events), "event"), "all": count(len(self.events)), "rest": len(self.events) > len(shown),
            "table": table(head, rows, frames=[one["view_frame"] for one in shown]),
        }

    def phases(self):
        colours = phase_colours(self.run.species, self.run.matrix)
        if self.sample and "phases" in self.sample:
            rows = []
            for phase in self.sample["phases"]:
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
            at_faces = f"{shape['objects_at_boundary']} left out at the outer faces" if "objects_at_boundary" in shape else ""
            smallest = f"smallest has {self.sample['smallest_object']} particles" if self.sample and "smallest_object" in \
                self.sample else ""
            rows.append(("objects", str(self.run.objects),
                         ", ".join(filter(None, (f"{shape['objects_used']} measured", f"{shape['objects_too_small']} too small", at_faces, smallest)))))
        return table(["check", "value", "how"], rows, words=(2,))

    def objects(self):
        columns = self.tables.get("shape_factor")
        unit, factor = self.run.unit
        rows = []
        if columns is not None and len(columns["object"]):
            first, last = (columns["frame"] == frame for frame in (min(columns["frame"]), max(columns["frame"])))
            before = dict(zip(columns["object"][first], columns["shape_factor"][first]))
            for k in np.flatnonzero(last)[:MOST_ROWS]:
                name = int(columns["object"][k])
                start = before.get(columns["object"][k], np.nan)
                rows.append((swatch(object_colour(name), str(name)), count(int(columns["particles"][k])),
                             number(factor**3 * columns["volume_estimate"][k]), fixed(start, 3),
                             fixed(columns["shape_factor"][k], 3), fixed(columns["shape_factor"][k] / start, 3)))
        head = ["object", "particles", f"volume, by its particles [{unit}³]", "shape factor before", "after", "after / before"]
        return table(head, rows)

    def pores(self):
        columns = self.tables.get("pores_each")
        unit, factor = self.run.unit
        rows, at = [], 0
        if columns is not None and len(columns["pore"]):
            at = int(max(columns["frame"]))
            for k in np.flatnonzero(columns["frame"] == at)[:MOST_ROWS]:
                volume = columns["volume_corrected"][k]
                rows.append((str(int(columns["pore"][k])), count(int(columns["particles"][k])),
                             number(factor**3 * volume) if np.isfinite(volume) else "",
                             fixed(columns["sphericity"][k], 3) if np.isfinite(columns["sphericity"][k]) else "",
                             "open" if columns["mouth_area"][k] > 0 else "closed",
                             ", ".join(number(factor * columns[f"centre_{axis}"][k], 4) for axis in "xyz")))
        head = ["pore", "particles around it", f"volume [{unit}³]", "sphericity", "", f"centre x, y, z [{unit}]"]
        return {**table(head, rows), "frame": at}

    def costs(self):
        all_steps = {**self.steps, **self.view["costs"]}
        if not all_steps:
            return None
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
        shown = {
            "view": self.viewer(), "pictures": self.pictures(), "measures": self.measures(), "topology": self.events_of_topology(),
            "errors": True, "costs": self.costs(), "scene": origin.scene, "commands": self.commands(),
        }
        titles = {"view": "3-D view", "topology": "events"}
        return filled(
            "page.html", name=self.name(), style=as_it_is(own_text("page.css")), facts=self.facts(),
            sections=[(anchor, titles.get(anchor, anchor)) for anchor, value in shown.items()
                      if value or (anchor == "topology" and value is not None)],
            key_figures=self.key_figures(), warnings=self.warnings(), view=shown["view"], pictures=shown["pictures"],
            moved=self.run.frame_count > 1, measures=shown["measures"], events=shown["topology"], phases=self.phases(),
            checks=self.checks(), objects=self.objects(), pores=self.pores(), costs=shown["costs"], scene=origin.scene,
            commands=shown["commands"], version=origin.version, run=self.run.path.name,
            xdmf=self.run.path.with_suffix(".xdmf").name)
