#!/usr/bin/python3
"""What `plan` predicts for images that its table was not made of, beside what the runs give.

usage: held_out.py BIN [--folder held_out] [--cases inclusions foam pores] [--packings 2] [--table TABLE.toml]

Each case: a phantom, a scene and a wanted error go to `plan`; the commands that it prints are run with other packings, and
what they measure is compared with one run of law "norton", 1.3 to 2 times finer than the proposal. A finished file stays.
Prints a table; CPU seconds are those of a busy machine where it is busy.
"""
import argparse
import csv
import json
import pathlib
import shlex
import subprocess

import numpy as np

SCENE = """# Held out.
[phase.a]
label = 1
law = "norton"
norton = {{ K = {a[0]}, M = {a[1]} }}
{more}[load]
steps = [ {{ strain = {strain}, rate = 1e-3 }} ]
[accuracy]
frames = {frames}
"""
B = "[phase.b]\nlabel = 2\nlaw = \"norton\"\nnorton = { K = 5020, M = 0.49 }\nobjects = true\n"
# phantom, scene, wanted error [%], how much finer the reference is, its strain_per_step
CASES = {
    "inclusions": ("phantom_inclusions {image} --size 60 --voxel-size 10um --fraction 0.12 --count 2 --random-seed 3",
                   SCENE.format(a=(100, 0.1), more=B, strain=-0.33, frames=33), 10, 2, 4e-3),
    "foam": ("phantom_foam {image} --size 90 --voxel-size 10um --relative-density 0.25 --cells 1 --irregularity 0.5 --random-seed 5",
             SCENE.format(a=(49.1, 0.0714), more="", strain=-0.31, frames=31), 20, 1.3, 4e-3),
    "pores": ("phantom_pores {image} --size 70 --voxel-size 10um --porosity 0.05 --median-diameter 240um --spread 0.1 --clusters 0 "
              "--random-seed 4", SCENE.format(a=(49.1, 0.0714), more="", strain=-0.21, frames=21), 10, 1.5, 4e-3),
}

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("held_out"))
parser.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
parser.add_argument("--packings", type=int, default=2)
parser.add_argument("--table", type=pathlib.Path)
options = parser.parse_args()
tools = options.bin.resolve()
table = ["--table", str(options.table.resolve())] if options.table else []


def tool(*words):
    words = [str(word) for word in words]
    one_thread = ["--threads", "1"] if json.loads(subprocess.check_output([tools / words[0], "--describe"]))["threads"] else []
    subprocess.run([str(tools / words[0]), *words[1:], "--quiet", *one_thread], check=True)


def once(output, *words):
    """Runs a tool whose summary is beside its output, if it was not yet; its summary."""
    summary = output.with_suffix(".json")
    if not summary.exists():
        tool(*words, "--json", summary)
    return json.loads(summary.read_text())


def column(path, name, at):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return float(np.interp(at, [float(row["abs_strain [-]"]) for row in rows], [float(row[name]) for row in rows]))


def shape(path, at):
    """Mean over the objects, by their volume."""
    with open(path) as file:
        rows = [row for row in csv.DictReader(file) if abs(float(row["abs_strain [-]"]) - at) < 0.006]
    weight = [float(row["volume_estimate [mm^3]"]) for row in rows]
    return float(np.average([float(row["shape_factor [-]"]) for row in rows], weights=weight))


def measured(name, run):
    if name == "pores":
        tool("pores", run, run.with_suffix(".pores.csv"), "--closed-only")
        return {"pore_volume": column(run.with_suffix(".pores.csv"), "volume_corrected [mm^3]", 0.2)}
    at = {"foam": (0.25, 0.05), "inclusions": (0.3, 0.02)}[name]
    tool("stress_strain", run, run.with_suffix(".csv"), "--at", at[0], "--window", at[1], "--json", run.with_suffix(".stress.json"))
    stress = json.loads(run.with_suffix(".stress.json").read_text())["flow_stress_engineering"]
    if name == "foam":
        return {"foam_stress": stress}
    tool("shape_factor", run, run.with_suffix(".shape.csv"))
    return {"composite_stress": stress, "shape_factor": shape(run.with_suffix(".shape.csv"), 0.3)}


def made(folder, name, commands, packing):
    """Runs the commands of a plan in a folder; measures, CPU seconds of solve and of all before, peak bytes."""
    folder.mkdir(exist_ok=True)
    summaries = {}
    for command in commands:
        words = shlex.split(command)
        if words[0] == "packgen":
            words += ["--random-seed", packing]
        if words[0] == "vol2pack":
            words += ["--random-seed", packing]
        words = [str((folder.parent if str(word) in ("image.tif", "proposed.toml", "fine.toml") else folder) / word)
                 if str(word).endswith((".h5", ".tif", ".toml")) else word for word in words]
        output = folder / {"packgen": "brick", "vol2pack": "sample", "carve": "relaxed", "relax": "relaxed", "solve": "run"}[words[0]]
        summaries[words[0]] = once(output.with_suffix(".h5"), *words)
    solve = summaries.pop("solve")
    before = sum(one["cpu_seconds"] for key, one in summaries.items() if key != "packgen")
    return {"values": measured(name, folder / "run.h5"), "cpu": solve["cpu_seconds"], "before": before,
            "bytes": max(one["peak_bytes"] for one in (solve, *summaries.values())), "particles": solve["particles"],
            "steps": solve["steps"]}


print("| case | proposed | quantity | predicted error | measured | CPU of solve, predicted | measured | before it, predicted | measured "
      "| memory, predicted | measured |\n|" + "---|" * 11, flush=True)
for name in options.cases:
    phantom, text, wanted, finer, step = CASES[name]
    folder = options.folder / name
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "image.tif").exists():
        tool(*shlex.split(phantom.format(image=folder / "image.tif")))
    (folder / "scene.toml").write_text(text)
    tool("plan", folder / "image.tif", folder / "proposed.toml", "--scene", folder / "scene.toml", "--error", f"{wanted}%",
         *table, "--json", folder / "plan.json")
    plan = json.loads((folder / "plan.json").read_text())
    clean = lambda command: command.replace(str(folder) + "/", "")
    commands = [clean(plan[f"command_{key}"]) for key in ("packgen", "vol2pack", "carve", "relax", "solve") if f"command_{key}" in plan]
    setting = f"{plan['law']}-{plan['pixels_per_seed']:.3f}-{plan['strain_per_step']:.3g}"
    runs = [made(folder / f"{setting}-{packing}", name, commands, packing) for packing in range(11, 11 + options.packings)]

    # The reference: finer, norton.
    pixels = plan["pixels_per_seed"] / finer
    particles = plan["particles"] * finer**3
    (folder / "fine.toml").write_text(f"{text}strain_per_step = {step}\n")
    fine = []
    for command in commands:
        words = shlex.split(clean(command).replace("proposed.toml", "fine.toml"))
        if words[0] == "packgen":
            words[words.index("--density") + 1] = "0.64"
            words[words.index("--particles") + 1] = f"{min(20000, particles):.0f}"
        if words[0] == "vol2pack":
            words[words.index("--pixels-per-seed") + 1] = f"{pixels:.4g}"
        fine.append(shlex.join(words))
    truth = made(folder / f"fine-{pixels:.3f}", name, fine, 1)

    for k, predicted in enumerate(plan["predicted_errors"]):
        quantity = predicted["quantity"]
        errors = [100 * (run["values"][quantity] / truth["values"][quantity] - 1) for run in runs]
        mean = lambda key: np.mean([run[key] for run in runs])
        cells = [name, f"{plan['law'].upper()}, {plan['particles']} particles, {setting.split('-', 2)[2]}", quantity,
                 f"{100 * predicted['error']:.1f} %", ", ".join(f"{error:+.1f} %" for error in errors)]
        if k == 0:
            cells += [f"{plan['predicted_cpu_seconds']:.2g} s", f"{mean('cpu'):.2g} s", f"{plan['predicted_prepare_cpu_seconds']:.2g} s",
                      f"{mean('before'):.2g} s", f"{plan['predicted_peak_bytes'] / 1e6:.0f} MB", f"{mean('bytes') / 1e6:.0f} MB"]
        else:
            cells += [""] * 6
        print("| " + " | ".join(cells) + " |", flush=True)
