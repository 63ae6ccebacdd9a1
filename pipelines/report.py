#!/usr/bin/python3
"""Puts what a pipeline made into one self-contained page: pictures, curves, errors, costs, the scene.

usage: report.py FOLDER REPORT.html --steps STEP...

FOLDER holds a STEP.json (the tool's --json) for every step, picture_{cut,inclusions,mesh}_{before,after}.png, the tables
of the metrics and scene.toml.
"""
import argparse
import base64
import csv
import html
import io
import json
import os
import pathlib
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

INK, ORANGE, BLUE, GREY = "#28303c", "#d55e00", "#0072b2", "#9aa3af"

STYLE = """
:root { color-scheme: light; --ink: #28303c; --soft: #667085; --line: #e3e7ed; --wash: #f6f8fa; --accent: #d55e00; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: white; font: 16px/1.55 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0; } h1 + p { color: var(--soft); margin: .4rem 0 2rem; max-width: none; }
h2 { font-size: 1.25rem; margin: 3rem 0 .8rem; padding-top: 1.2rem; border-top: 1px solid var(--line); }
p { max-width: 75ch; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(165px, 1fr)); gap: .8rem; }
.figures div { background: var(--wash); border-radius: .5rem; padding: .8rem 1rem; }
.figures b { display: block; font-size: 1.45rem; line-height: 1.25; font-variant-numeric: tabular-nums; white-space: nowrap; }
.figures span { color: var(--soft); font-size: .86rem; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 1rem; margin: 0 0 1rem; }
figure { margin: 0; border: 1px solid var(--line); border-radius: .5rem; overflow: hidden; }
figure img, figure svg { display: block; width: 100%; height: auto; }
figcaption { padding: .55rem .9rem; font-size: .9rem; color: var(--soft); border-top: 1px solid var(--line); }
.doubt { border-left: .3rem solid var(--accent); background: #fff4ec; padding: .6rem 1rem; max-width: none; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .93rem; font-variant-numeric: tabular-nums; }
th, td { padding: .4rem .8rem .4rem 0; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { font-weight: 600; color: var(--soft); } th:first-child, td:first-child { text-align: left; }
td.words, th.words { text-align: left; white-space: normal; }
td .soft { color: var(--soft); } tr.sum td { font-weight: 600; border-bottom: 0; }
pre { background: var(--wash); border-radius: .5rem; padding: 1rem; overflow-x: auto; font-size: .86rem; line-height: 1.45; }
code { font-size: .9em; } a { color: #0b5cad; }
@media print { h2 { break-after: avoid; } figure { break-inside: avoid; } }
"""

PICTURES = {
    "cut": "The sample cut open in its middle",
    "inclusions": "The inclusions alone",
    "mesh": "Their surface, rebuilt from the particles",
}


def read_table(path):
    """Column name without its unit -> values; an empty cell is not a number."""
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    columns = zip(*rows) if rows else [[] for _ in head]
    return {
        name.split(" [")[0]: np.array([float(cell) if cell else np.nan for cell in column])
        for name, column in zip(head, columns)
    }


def number(value, digits=3):
    return f"{value:.{digits}g}".replace("-", "−")


def percent(value, digits=2):
    return f"{100 * value:.{digits}f} %".replace("-", "−")


def count(value):
    return f"{value:,}".replace(",", "\u202f")


def seconds(value):
    if value < 60:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def mebibytes(value):
    return f"{count(round(value / 2**20))} MiB"


def table(head, rows, words=(), total=False):
    def cells(tag, row):
        return "".join(
            f'<{tag}{" class=words" if column in words else ""}>{cell}</{tag}>' for column, cell in enumerate(row)
        )

    last = len(rows) - 1
    body = "".join(
        f'<tr{" class=sum" if total and index == last else ""}>{cells("td", row)}</tr>' for index, row in enumerate(rows)
    )
    return f'<div class=scroll><table><tr>{cells("th", head)}</tr>{body}</table></div>'


def picture(path, caption):
    data = base64.b64encode(path.read_bytes()).decode()
    text = html.escape(caption)
    return f'<figure><img src="data:image/png;base64,{data}" alt="{text}"><figcaption>{text}</figcaption></figure>'


def plot(draw, caption):
    with plt.rc_context({
        "font.size": 10.5, "font.family": "DejaVu Sans", "axes.spines.top": False, "axes.spines.right": False,
        "axes.edgecolor": GREY, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.grid": True,
        "grid.color": "#e9edf2", "legend.frameon": False, "svg.fonttype": "path", "svg.hashsalt": "tomodem",
    }):
        figure, axes = plt.subplots(figsize=(6.2, 4.2), layout="constrained")
        draw(axes)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)
    svg = stream.getvalue()
    # Ids are unique in one drawing only; several share this page.
    plot.count = getattr(plot, "count", 0) + 1
    for mark in ('id="', 'href="#', "url(#"):
        svg = svg.replace(mark, f"{mark}p{plot.count}-")
    return f'<figure>{svg[svg.index("<svg"):]}<figcaption>{caption}</figcaption></figure>'


def norton_of_phases(scene):
    """Label -> flow stress [Pa] at the rate of the first step, for the phases given by their Norton law."""
    rate = scene["load"]["steps"][0]["rate"]
    if isinstance(rate, str):
        return {}
    return {
        phase["label"]: 1e6 * phase["norton"]["K"] * rate ** phase["norton"]["M"]
        for phase in scene["phase"].values()
        if "norton" in phase
    }


class Report:
    def __init__(self, folder, steps):
        self.folder = folder
        self.step = {name: json.loads((folder / f"{name}.json").read_text()) for name in steps}
        self.scene_text = (folder / "scene.toml").read_text()
        self.scene = tomllib.loads(self.scene_text)
        self.tables = {
            name: read_table(folder / f"{name}.csv")
            for name in ("stress_strain", "shape_factor", "shape_factor_means", "volume_change", "equilibrium")
        }
        self.phases = self.step["sample"]["phases"]
        self.names = {phase["label"]: name for name, phase in self.scene["phase"].items()}

    def title(self):
        image = self.step["image"]
        size = " × ".join(str(image[f"size_{axis}"]) for axis in "xyz")
        extent = " × ".join(number(image[f"extent_{axis}"]) for axis in "xyz")
        return (
            "<h1>Tomography to forming</h1>"
            f"<p>{html.escape(self.image_name())}: {size} voxels, {extent} mm; "
            f"{count(self.step['run']['particles'])} particles of radius "
            f"{number(1000 * self.step['sample']['seed_radius'])} µm</p>"
        )

    def image_name(self):
        if "phantom" in self.step:
            return "Phantom composite"
        words = self.step["image"]["command_line"].split()
        return "/".join(pathlib.PurePath(words[1]).parts[-2:]) if len(words) > 1 else "Image"

    def key_figures(self):
        step = self.step
        figures = [(number(step["run"]["final_strain"]), "true strain reached")]
        if "flow_stress" in step["stress_strain"]:
            stress = step["stress_strain"]
            span = f"|strain| {number(stress['flow_abs_strain_from'])} to {number(stress['flow_abs_strain_to'])}"
            figures.append((f"{stress['flow_stress'] / 1e6:.1f} MPa", f"flow stress, {span}"))
        else:
            figures.append((f"{abs(step['run']['final_stress']) / 1e6:.1f} MPa", "stress at the end"))
        shape = step["shape_factor"]
        figures += [
            (f"{shape['shape_factor_last']:.3f}",
             f"shape factor, from {shape['shape_factor_first']:.3f}; mean of {shape['objects_used']} "
             f"object{'s' * (shape['objects_used'] != 1)}"),
            (percent(step["equilibrium"]["equilibrium_error"]), "equilibrium error"),
            (percent(step["volume_change"]["volume_change_last"]), "volume change"),
            (seconds(sum(one["wall_seconds"] for one in step.values())), "from image to measures"),
        ]
        return "<div class=figures>" + "".join(f"<div><b>{a}</b><span>{b}</span></div>" for a, b in figures) + "</div>"

    def warnings(self):
        """What makes a result doubtful, in words; also printed when the report is made."""
        step = self.step
        found = []
        equilibrium = step["equilibrium"]["equilibrium_error"]
        if equilibrium > 0.05:
            found.append(f"The two planes differ by {percent(equilibrium, 1)} of their force: inertia or too few particles "
                         "carry the load. Take a smaller strain_per_step, or smaller particles.")
        volume = step["volume_change"]["volume_change_last"]
        if abs(volume) > 0.1:
            found.append(f"The volume changed by {percent(volume, 1)}: parts that are only a few particles thick sinter into "
                         "lumps. Take smaller particles (PIXELS_PER_SEED) until the result no longer changes.")
        if step["run"].get("particles_lost", 0) > 0:
            found.append(f"{count(step['run']['particles_lost'])} particles were lost.")
        return found

    def doubts(self):
        return "".join(f"<p class=doubt>{html.escape(line)}</p>" for line in self.warnings())

    def pictures(self):
        parts = ["<h2>Before and after</h2>"]
        for what, caption in PICTURES.items():
            if what == "inclusions" and len(self.scene["phase"]) == 1:
                caption = "The whole sample"
            if what == "mesh" and len(self.scene["phase"]) == 1:
                caption = "Its surface, rebuilt from the particles"
            parts.append("<div class=pair>" + "".join(
                picture(self.folder / f"picture_{what}_{when}.png", f"{caption}, {when}") for when in ("before", "after")
            ) + "</div>")
        parts.append("<p>All pictures of a pair have the same place and scale; the thin box is the sample before.</p>")
        return "".join(parts)

    def stress_plot(self, axes):
        curve = self.tables["stress_strain"]
        sign = -1 if curve["strain"][-1] < 0 else 1
        axes.plot(curve["abs_strain"], sign * curve["stress_true"] / 1e6, color=INK, lw=2, label="true stress")
        axes.plot(curve["abs_strain"], sign * curve["stress_engineering"] / 1e6, color=GREY, lw=1.4,
                  label="engineering stress")
        of_phase = norton_of_phases(self.scene)
        solid = [phase for phase in self.phases if phase["label"] != 0]
        dense = sum(phase["sample_fraction"] for phase in solid) > 0.99
        if dense and len(solid) > 1 and all(phase["label"] in of_phase for phase in solid):
            mixture = sum(phase["sample_fraction"] * of_phase[phase["label"]] for phase in solid)
            axes.axhline(mixture / 1e6, color=BLUE, lw=1.2, ls="--", label="phases in parallel (Norton)")
        axes.set(xlabel="|true strain|", ylabel=("compressive " if sign < 0 else "") + "stress [MPa]", xlim=(0, None))
        axes.legend(loc="lower right")

    def shape_plot(self, axes):
        objects, means = self.tables["shape_factor"], self.tables["shape_factor_means"]
        for name in np.unique(objects["object"]):
            rows = objects["object"] == name
            axes.plot(objects["abs_strain"][rows], objects["shape_factor"][rows], color=GREY, lw=0.6, alpha=0.6)
        axes.plot([], [], color=GREY, lw=0.8, label="each object")
        strain, mean = means["abs_strain"], means["shape_factor_weighted"]
        axes.plot(strain, mean, color=ORANGE, lw=2.4, label="mean, by volume")
        axes.plot(strain, mean[0] * np.exp(1.5 * means["strain"]), color=INK, lw=1.2, ls="--",
                  label="if it deformed as the sample")
        axes.set(xlabel="|true strain|", ylabel="shape factor H/D", xlim=(0, None))
        axes.legend(loc="lower left")

    def volume_plot(self, axes):
        curve = self.tables["volume_change"]
        axes.plot(curve["abs_strain"], 100 * curve["volume_change"], color=INK, lw=2, marker="o", ms=3)
        axes.set(xlabel="|true strain|", ylabel="volume change [%]", xlim=(0, None))

    def equilibrium_plot(self, axes):
        curve = self.tables["equilibrium"]
        positive = curve["equilibrium_error"] > 0
        axes.semilogy(curve["abs_strain"][positive], 100 * curve["equilibrium_error"][positive], color=INK, lw=1.4)
        axes.set(xlabel="|true strain|", ylabel="equilibrium error [%]", xlim=(0, None), ylim=(1e-2, None))

    def curves(self):
        return (
            "<h2>Curves</h2><div class=pair>"
            + plot(self.stress_plot, "Stress against strain, forces averaged over a window of strain")
            + plot(self.shape_plot, "Shape factor against strain: height along the load over width across it")
            + "</div><div class=pair>"
            + plot(self.volume_plot, "Volume of the sample (alpha shape of the particle centres)")
            + plot(self.equilibrium_plot, "|F<sub>top</sub> + F<sub>bottom</sub>| over the mean of |F|")
            + "</div>"
        )

    def errors(self):
        step, rows = self.step, []
        for phase in self.phases:
            if phase["label"] == 0 and phase["image_fraction"] == 0:
                continue
            name = self.names.get(phase["label"], phase["name"] or f"label {phase['label']}")
            difference = phase["sample_fraction"] - phase["image_fraction"]
            points = f"{100 * difference:+.2f} points".replace("-", "−")
            rows.append((html.escape(name), percent(phase["image_fraction"]), percent(phase["sample_fraction"]), points,
                         count(phase["particles"]) if phase["label"] else ""))
        particles = step["sample"]["particles"]
        lost = particles - step["run"]["particles"] + step["run"].get("particles_lost", 0)
        shape, equilibrium, volume = step["shape_factor"], step["equilibrium"], step["volume_change"]
        at_faces = f"{shape['objects_at_boundary']} left out at the outer faces; " if "objects_at_boundary" in shape else ""
        checks = [
            ("particles lost", f"{lost} of {count(particles)}", ""),
            ("equilibrium error", percent(equilibrium["equilibrium_error"], 3),
             f"mean over |strain| {number(equilibrium['abs_strain_from'])} to {number(equilibrium['abs_strain_to'])}; "
             f"largest {percent(equilibrium['equilibrium_error_max'], 3)}"),
            ("volume change", percent(volume["volume_change_last"]),
             f"at the end; largest on the way {percent(volume['volume_change_extreme'])}"),
            ("objects", str(step["sample"].get("objects", 0)),
             f"{shape['objects_used']} measured, {shape['objects_too_small']} too small, "
             f"{at_faces}"
             f"smallest has {step['sample'].get('smallest_object', 0)} particles"),
        ]
        return (
            "<h2>Errors</h2>"
            + table(["phase", "image", "sample", "difference", "particles"], rows)
            + "<p></p>"
            + table(["check", "value", "how"], checks, words=(2,))
        )

    @staticmethod
    def which(name, tool):
        """Tells the runs of a tool apart that is used several times."""
        _, _, words = name.partition("_")
        return f' <span class=soft>{words.replace("_", " ")}</span>' if tool in ("render", "mesh_recon") else ""

    def costs(self):
        rows = [
            (html.escape(one["tool"]) + self.which(name, one["tool"]),
             seconds(one["wall_seconds"]), seconds(one["cpu_seconds"]), mebibytes(one["peak_bytes"]))
            for name, one in self.step.items()
        ]
        rows.append(("all", seconds(sum(one["wall_seconds"] for one in self.step.values())),
                     seconds(sum(one["cpu_seconds"] for one in self.step.values())),
                     mebibytes(max(one["peak_bytes"] for one in self.step.values()))))
        run = self.step["run"]
        note = f"<p>{count(run['steps'])} time steps of {number(run['time_step'])} s on {run['processes']} "
        note += f"process{'es' * (run['processes'] != 1)}"
        if "seconds_per_particle_step" in run:
            note += f"; {1e6 * run['seconds_per_particle_step']:.2f} µs of CPU time a particle and step"
        return "<h2>Costs</h2>" + table(["step", "time", "CPU time", "peak memory"], rows, total=True) + note + ".</p>"

    def how(self):
        commands = "\n".join(one["command_line"] for one in self.step.values())
        version = html.escape(self.step["run"]["version"])
        return (
            f"<h2>Scene</h2><pre>{html.escape(self.scene_text)}</pre>"
            f"<h2>Commands</h2><p>tomodem {version}. The files are beside this page; <code>run.h5</code> is H5MD, "
            f"<code>run.xdmf</code> opens it in ParaView.</p><pre>{html.escape(commands)}</pre>"
        )

    def page(self):
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>tomodem: {html.escape(self.image_name())}</title><style>{STYLE}</style></head><body><main>"
            + self.title() + self.key_figures() + self.doubts() + self.pictures() + self.curves() + self.errors() + self.costs()
            + self.how() + "</main></body></html>\n"
        )


def main():
    parser = argparse.ArgumentParser(prog="report", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("--steps", nargs="+", required=True)
    options = parser.parse_args()
    report = Report(options.folder, options.steps)
    page = report.page()
    part = options.report.with_name(f".{options.report.name}.part-{os.getpid()}")
    part.write_text(page)
    part.rename(options.report)
    for line in report.warnings():
        print("report: warning:", line, file=sys.stderr)


main()
