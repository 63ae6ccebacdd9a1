"""The page: what the pieces say, in sections; a section without its pieces is left out."""
import base64
import html
import importlib.resources
import json
import pathlib

import numpy as np

import plots
from command_line import InvalidInput
from words import (count, fixed, length, mebibytes, number, object_colour, percent, phase_colours, plural, read_table,
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


def own_text(name):
    return importlib.resources.files("assets").joinpath(name).read_text(encoding="utf-8")


def table(head, rows, words=(), total=False, attributes=None):
    def cells(tag, row):
        return "".join(
            f'<{tag}{" class=words" if column in words else ""}>{cell}</{tag}>' for column, cell in enumerate(row)
        )

    last = len(rows) - 1
    body = "".join(
        f'<tr{" class=sum" if total and index == last else ""}{attributes[index] if attributes else ""}>{cells("td", row)}</tr>'
        for index, row in enumerate(rows)
    )
    return f'<div class="scroll{" tall" * (len(rows) > 12)}"><table><tr>{cells("th", head)}</tr>{body}</table></div>'


def picture(path, caption):
    data = base64.b64encode(path.read_bytes()).decode()
    text = html.escape(caption)
    return f'<figure><img src="data:image/png;base64,{data}" alt="{text}"><figcaption>{text}</figcaption></figure>'


def curve(svg, caption):
    return f"<figure>{svg}<figcaption>{caption}</figcaption></figure>"


def pairs(figures):
    return "".join(f'<div class=pair>{"".join(figures[k:k + 2])}</div>' for k in range(0, len(figures), 2))


def strain_text(strain):
    return f"true strain {fixed(strain, 3)}" if np.isfinite(strain) else ""


class Page:
    """@param steps  Steps of the run: what its making and measuring cost"""

    def __init__(self, run, shop, steps, view):
        self.run, self.shop, self.view = run, shop, view
        self.steps = steps.of_run
        self.sample = steps.first("vol2pack")
        self.image = steps.first("volume_info")
        self.phantom = steps.first("phantom_")
        self.solved = next(
            (one for one in self.steps.values() if one["command_line"] == run.provenance.command_line), {})
        self.summary = {name: shop.summary(name) for name in
                        ("stress_strain", "shape_factor", "volume_change", "equilibrium", "topology", "pores",
                         "coordination", "crystallinity", "control_numbers")}
        self.tables = {name: read_table(shop.folder / f"{name}.csv") for name, one in self.summary.items() if one}
        if self.summary["shape_factor"]:
            self.tables["shape_factor_means"] = read_table(shop.folder / "shape_factor_means.csv")
        if self.summary["pores"]:
            self.tables["pores_each"] = read_table(shop.folder / "pores_each.csv")
        if self.summary["topology"]:
            self.tables["topology_events"] = read_table(shop.folder / "topology_events.csv")
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
    def title(self):
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
            parts.append(", ".join(html.escape(self.phase_name(label)) for label in sorted(run.species)))
        parts.append(plural(run.frame_count, "frame"))
        return f"<h1>{html.escape(self.name())}</h1><p>{'; '.join(parts)}</p>"

    def key_figures(self):
        figures, found = [], self.summary
        if "strain" in self.run.curves and self.run.frame_count > 1:
            figures.append((number(self.run.frame_strain[-1]), "true strain reached"))
        stress = found["stress_strain"] or {}
        if "flow_stress" in stress:
            span = f"|strain| {number(stress['flow_abs_strain_from'])} to {number(stress['flow_abs_strain_to'])}"
            figures.append((f"{fixed(stress['flow_stress'] / 1e6, 1)} MPa", f"flow stress, {span}"))
        elif "final_stress" in self.solved:
            figures.append((f"{abs(self.solved['final_stress']) / 1e6:.1f} MPa", "stress at the end"))
        if shape := found["shape_factor"]:
            figures.append((f"{shape['shape_factor_last']:.3f}",
                            f"shape factor, from {shape['shape_factor_first']:.3f}; mean of "
                            f"{plural(shape['objects_used'], 'object')}"))
        if found["pores"] and max(porosity := self.tables["pores"]["porosity"]) > 0:
            figures.append((percent(porosity[-1]), f"porosity, from {percent(porosity[0])}" if len(porosity) > 1 else "porosity"))
        if equilibrium := found["equilibrium"]:
            figures.append((percent(equilibrium["equilibrium_error"]), "equilibrium error"))
        if volume := found["volume_change"]:
            figures.append((percent(volume["volume_change_last"]), "volume change of the solid"))
        if self.solved or self.sample:
            figures.append((seconds(self.time_of_steps()), "from image to measures" if self.sample else "all steps"))
        return "<div class=figures>" + "".join(f"<div><b>{a}</b><span>{b}</span></div>" for a, b in figures) + "</div>"

    def warnings(self):
        """What makes a result doubtful, in words; also printed when the report is made."""
        found = []
        if one := self.summary["equilibrium"]:
            if one["equilibrium_error"] > 0.05:
                found.append(f"The two planes differ by {percent(one['equilibrium_error'], 1)} of their force: inertia or too "
                             "few particles carry the load. Take a smaller strain_per_step, or smaller particles.")
        if one := self.summary["volume_change"]:
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

    def doubts(self):
        return "".join(f"<p class=doubt>{html.escape(line)}</p>" for line in self.warnings())

    def viewer(self):
        run, view = self.run, self.view
        if not view["layers"]:
            return ""
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
        note = (f"{every}Surfaces through the centres of the outermost particles, {count(view['triangles'])} triangles after "
                "coarsening for this page.")
        return (
            "<h2 id=view>In three dimensions</h2>" + own_text("viewer.html")
            + f"<p>{note}</p>"
            + f'<script type="application/json" id="view-data">{json.dumps(data, allow_nan=False)}</script>'
            + f"<script>{THREE.read_text(encoding='utf-8')}</script><script>{own_text('viewer.js')}</script>"
        )

    def pictures(self):
        figures = []
        several = len(self.run.species) > 1
        for what, caption in PICTURES.items():
            if what == "inclusions" and not several:
                caption = "The whole sample"
            if what == "mesh" and not several:
                caption = "Its surface, rebuilt from the particles"
            figures += [
                picture(self.shop.folder / f"picture_{what}_{when}.png",
                        f"{caption}, {when}" if self.run.frame_count > 1 else caption)
                for when in ("before", "after") if self.shop.has(f"picture_{what}_{when}")
            ]
        if not figures:
            return ""
        moved = self.run.frame_count > 1
        note = "<p>The pictures of a pair have the same place and scale; the thin box is the sample before.</p>" if moved else ""
        return f"<h2 id=pictures>{'Before and after' if moved else 'Pictures'}</h2>{pairs(figures)}{note}"

    def shares_of_dense_phases(self):
        """Label -> share of the sample, or nothing if it is porous or of one phase."""
        if not self.sample or "phases" not in self.sample:
            return {}
        shares = {one["label"]: one["sample_fraction"] for one in self.sample["phases"] if one["label"] != 0}
        return shares if len(shares) > 1 and sum(shares.values()) > 0.99 else {}

    def curves(self):
        found, figures = self.tables, []
        if "stress_strain" in found:
            svg = plots.stress(found["stress_strain"], self.run.scene, self.shares_of_dense_phases())
            figures.append(curve(svg, "Stress against strain, forces averaged over a window of strain"))
        if "shape_factor" in found and self.run.frame_count > 1:
            figures.append(curve(plots.shapes(found["shape_factor"], found["shape_factor_means"]),
                                 "Shape factor against strain: height along the load over width across it"))
        if "volume_change" in found:
            figures.append(curve(plots.volume(found["volume_change"]),
                                 "Volume of the sample (alpha shape of the particle centres)"))
        if "equilibrium" in found:
            figures.append(curve(plots.equilibrium(found["equilibrium"]),
                                 "|F<sub>top</sub> + F<sub>bottom</sub>| over the mean of |F|"))
        if "pores" in found and self.run.frame_count > 1 and max(found["pores"]["porosity"]) > 0:
            figures.append(curve(plots.porosity(found["pores"]),
                                 "Pores up to where the material ends, those with a mouth too, in the volume of sample and pores"))
        if "topology" in found and self.run.frame_count > 1:
            columns = found["topology"]
            if any(min(columns[name]) != max(columns[name]) for name in ("b0", "b1", "b2")):
                figures.append(curve(plots.topology(columns), "Parts, handles and closed pores of the sample"))
        return "<h2 id=curves>Curves</h2>" + pairs(figures) if figures else ""

    def topology(self):
        columns = self.tables.get("topology")
        if columns is None:
            return ""
        rows = [
            (f"frame {int(columns['frame'][k])}", fixed(columns["strain"][k], 3) if np.isfinite(columns["strain"][k]) else "",
             *(count(int(columns[name][k])) for name in ("b0", "b1", "b2")))
            for k in sorted({0, len(columns["frame"]) - 1})
        ]
        text = "<h2 id=topology>Parts, handles and pores</h2>" + table(
            ["", "true strain", "parts", "handles", "closed pores"], rows)
        if self.run.frame_count < 2:
            return text
        if not self.events:
            return text + "<p>Nothing merged, split, opened or closed on the way, the whole sample taken as one material.</p>"
        shown = self.events[:MOST_ROWS]
        unit, factor = self.run.unit
        rows = [
            (html.escape(one["name"]), f"{fixed(one['strain_before'], 3)} to {fixed(one['strain'], 3)}", one["frame"],
             ", ".join(number(factor * value, 4) for value in one["place"]), number(factor**3 * one["volume"]))
            for one in shown
        ]
        attributes = [f' data-view-frame="{one["view_frame"]}" title="show this frame"' for one in shown]
        rest = len(self.events) - len(shown)
        more = f"<p>The first {count(len(shown))} of {count(len(self.events))}; the others are in topology_events.csv.</p>"
        return (
            text + f"<h3>{plural(len(self.events), 'event')}</h3>"
            + table(["event", "true strain", "seen in frame", f"place x, y, z [{unit}]", f"volume [{unit}³]"], rows,
                    attributes=attributes)
            + more * (rest > 0)
        )

    def phases(self):
        colours = phase_colours(self.run.species, self.run.matrix)
        def swatch(label):
            return f'<i style="background:{colours[label]}"></i>' if label in colours else ""

        if self.sample and "phases" in self.sample:
            rows = []
            for phase in self.sample["phases"]:
                label = phase["label"]
                if label == 0 and phase["image_fraction"] == 0:
                    continue
                difference = 100 * (phase["sample_fraction"] - phase["image_fraction"])
                sign = "+" * (difference > 0)
                rows.append((swatch(label) + html.escape(self.phase_name(label, phase["name"])),
                             percent(phase["image_fraction"]), percent(phase["sample_fraction"]),
                             f"{sign}{fixed(difference, 2)} points", count(phase["particles"]) if label else ""))
            return table(["phase", "image", "sample", "difference", "particles"], rows)
        rows = [
            (swatch(label) + html.escape(self.phase_name(label)), count(particles), percent(particles / self.run.particles))
            for label, particles in sorted(self.run.species.items())
        ]
        return table(["phase", "particles", "share of the particles"], rows)

    def checks(self):
        found, rows = self.summary, []
        if self.sample and "particles" in self.sample:
            particles = self.sample["particles"]
            lost = particles - self.run.particles + self.solved.get("particles_lost", 0)
            rows.append(("particles lost", f"{lost} of {count(particles)}", "from the sample to the end of the run"))
        elif "particles_lost" in self.solved:
            rows.append(("particles lost", f"{self.solved['particles_lost']} of {count(self.run.particles)}", ""))
        stress = found["stress_strain"] or {}
        if "flow_stress_deviation" in stress:
            rows.append(("flow stress", f"{number(stress['flow_stress'] / 1e6, 4)} ± "
                                        f"{number(stress['flow_stress_deviation'] / 1e6, 2)} MPa",
                         f"mean and scatter over |strain| {number(stress['flow_abs_strain_from'])} to "
                         f"{number(stress['flow_abs_strain_to'])}"))
        if equilibrium := found["equilibrium"]:
            rows.append(("equilibrium error", percent(equilibrium["equilibrium_error"], 3),
                         f"mean over |strain| {number(equilibrium['abs_strain_from'])} to "
                         f"{number(equilibrium['abs_strain_to'])}; largest {percent(equilibrium['equilibrium_error_max'], 3)}"))
        if volume := found["volume_change"]:
            rows.append(("volume change of the solid", percent(volume["volume_change_last"]),
                         f"at the end; largest on the way {percent(volume['volume_change_extreme'])}"))
        if shape := found["shape_factor"]:
            at_faces = f"{shape['objects_at_boundary']} left out at the outer faces" if "objects_at_boundary" in shape else ""
            smallest = f"smallest has {self.sample['smallest_object']} particles" if self.sample and "smallest_object" in \
                self.sample else ""
            rows.append(("shape factor", f"{shape['shape_factor_last']:.3f} ± {shape['shape_factor_last_deviation']:.3f}",
                         "mean by volume at the end, and scatter of the objects"))
            rows.append(("objects", str(self.run.objects),
                         ", ".join(filter(None, (f"{shape['objects_used']} measured", f"{shape['objects_too_small']} too small", at_faces, smallest)))))
        return table(["check", "value", "how"], rows, words=(2,)) if rows else ""

    def objects(self):
        columns = self.tables.get("shape_factor")
        if columns is None or not len(columns["object"]):
            return ""
        first, last = (columns["frame"] == frame for frame in (min(columns["frame"]), max(columns["frame"])))
        before = dict(zip(columns["object"][first], columns["shape_factor"][first]))
        rows = []
        unit, factor = self.run.unit
        for k in np.flatnonzero(last)[:MOST_ROWS]:
            name = int(columns["object"][k])
            start = before.get(columns["object"][k], np.nan)
            rows.append((f'<i style="background:{object_colour(name)}"></i>{name}', count(int(columns["particles"][k])),
                         number(factor**3 * columns["volume_estimate"][k]), fixed(start, 3), fixed(columns["shape_factor"][k], 3),
                         fixed(columns["shape_factor"][k] / start, 3)))
        head = ["object", "particles", f"volume, by its particles [{unit}³]", "shape factor before", "after", "after / before"]
        return "<h3>Objects</h3>" + table(head, rows)

    def pores(self):
        columns = self.tables.get("pores_each")
        if columns is None or not len(columns["pore"]):
            return ""
        at = max(columns["frame"])
        rows = []
        unit, factor = self.run.unit
        for k in np.flatnonzero(columns["frame"] == at)[:MOST_ROWS]:
            volume = columns["volume_corrected"][k]
            rows.append((str(int(columns["pore"][k])), count(int(columns["particles"][k])),
                         number(factor**3 * volume) if np.isfinite(volume) else "",
                         fixed(columns["sphericity"][k], 3) if np.isfinite(columns["sphericity"][k]) else "",
                         "open" if columns["mouth_area"][k] > 0 else "closed",
                         ", ".join(number(factor * columns[f"centre_{axis}"][k], 4) for axis in "xyz")))
        head = ["pore", "particles around it", f"volume [{unit}³]", "sphericity", "", f"centre x, y, z [{unit}]"]
        return f"<h3>Pores in frame {int(at)}</h3>" + table(head, rows)

    CONTROL = (
        ("control_numbers", "density", "density D of the packing", 1),
        ("control_numbers", "stiffness_level", "stiffness level k/(P d)", 1),
        ("control_numbers", "inertial_number", "inertial number", 1),
        ("control_numbers", "Q", "kinetic energy over P d³", 1),
        ("control_numbers", "kinetic_over_elastic", "kinetic over elastic energy", 1),
        ("coordination", "mean_coordination", "contacts of a particle, mean", 1),
        ("coordination", "rattlers", "rattlers [% of the particles]", None),
        ("crystallinity", "crystalline", "crystalline particles [% of those inside]", 100),
    )

    def control(self):
        """How near the packing is to what the method assumes, from the rows of all phases together."""
        rows = []
        for name, column, words, factor in self.CONTROL:
            columns = self.tables.get(name)
            if columns is None or column not in columns:
                continue
            whole = np.flatnonzero(np.isnan(columns["species"]))
            values = columns[column][whole] * (100 / self.run.particles if factor is None else factor)
            if not len(values) or not np.isfinite(values).any():
                continue
            ends = sorted({0, len(values) - 1})
            rows.append((words, *(number(values[k]) if np.isfinite(values[k]) else "" for k in ends)))
        if not rows:
            return ""
        head = ["", *(["first frame", "last frame"] if len(rows[0]) > 2 else [""])]
        return "<h3>State of the packing</h3>" + table(head, rows)

    def errors(self):
        return ("<h2 id=errors>Errors and shapes</h2>" + self.phases() + "<p></p>" + self.checks() + self.objects() + self.pores()
                + self.control())

    @staticmethod
    def which(name, tool):
        """Tells the runs of a tool apart that is used several times."""
        words = name if tool not in ("render", "mesh_recon") else name.partition("_")[2]
        return f' <span class=soft>{html.escape(words.replace("_", " "))}</span>' if tool in ("render", "mesh_recon") else ""

    def costs(self):
        all_steps = {**self.steps, **self.view["costs"]}
        if not all_steps:
            return ""
        rows = [
            (html.escape(one["tool"]) + self.which(name, one["tool"]),
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
            notes.append(f"{1e6 * solved['seconds_per_particle_step']:.2f} µs of CPU time a particle and step")
        if "predicted_wall_seconds" in solved:
            notes.append(f"{seconds(solved['predicted_wall_seconds'])} were predicted")
        if not solved and self.run.provenance.tool == "solve":
            notes.append("What the run itself cost is not known: keep the summary of <code>solve --json</code> beside it")
        note = f"<p>{'; '.join(notes)}.</p>" if notes else ""
        return "<h2 id=costs>Costs</h2>" + table(["step", "time", "CPU time", "peak memory"], rows, total=True) + note

    def how(self):
        origin = self.run.provenance
        commands = [one["command_line"] for one in self.steps.values()]
        if origin.command_line and origin.command_line not in commands:
            commands.insert(0, origin.command_line)
        parts = []
        if origin.scene:
            parts.append(f"<h2 id=scene>Scene</h2><pre>{html.escape(origin.scene)}</pre>")
        if commands:
            name = html.escape(self.run.path.name)
            xdmf = html.escape(self.run.path.with_suffix(".xdmf").name)
            made = f"tomodem {html.escape(origin.version)}. " if origin.version else ""
            # A folder that was made for this page is gone by now; where it was says nothing.
            commands = [line.replace(f"{self.shop.folder}/", "") for line in commands]
            parts.append(f"<h2 id=commands>Commands</h2><p>{made}<code>{name}</code> is H5MD, <code>{xdmf}</code> opens it in "
                         f"ParaView.</p><pre>{html.escape(chr(10).join(commands))}</pre>")
        return "".join(parts)

    def text(self):
        sections = [self.viewer(), self.pictures(), self.curves(), self.topology(), self.errors(), self.costs(), self.how()]
        links = "".join(
            f'<a href="#{anchor}">{name}</a>'
            for anchor, name in (("view", "3-D view"), ("pictures", "pictures"), ("curves", "curves"), ("topology", "topology"),
                                 ("errors", "errors"), ("costs", "costs"), ("scene", "scene"), ("commands", "commands"))
            if any(f"<h2 id={anchor}>" in section for section in sections)
        )
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">'
            f"<title>tomodem: {html.escape(self.name())}</title><style>{own_text('page.css')}</style></head><body><main>"
            + self.title() + f"<nav>{links}</nav>" + self.key_figures() + self.doubts() + "".join(sections)
            + "</main></body></html>\n"
        )

