#!/usr/bin/python3
"""What law NORTON does: exponent, flow stress, tension, volume, time step, jump of the rate, several processes, and two
phases beside the finite elements.

usage: tables.py BIN [--folder norton_tables] [--packings 3] [--particles 2000] [--parts one jump step two]
                 [--exponents ...] [--fem FOLDER] [--laws norton bilin]

Samples of D = 0.64 are packed, relaxed under the law and pressed or pulled by the executables in BIN. `one`: the three
rates 1e-3, 1e-4, 1e-5 /s share reference_rate = 1e-3, that is all constants but mass and time step. A finished run
stays in the folder and is not done again. Prints tables, writes tables.md, tables.json and curves.png.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import shutil
import subprocess

import h5py
import numpy as np

import samples
from samples import PHASES, phase

RATES = [1e-3, 1e-4, 1e-5]
K = 100.0  # MPa.s^M of the single phase
WINDOW = 0.05  # of strain, each side

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("norton_tables"))
parser.add_argument("--packings", type=int, default=3)
parser.add_argument("--particles", type=int, default=2000)
parser.add_argument("--parts", nargs="+", default=["one", "jump", "step", "two"])
parser.add_argument("--exponents", type=float, nargs="+", default=[0.1, 0.25, 0.5, 0.75, 1.0])
parser.add_argument("--rates", type=float, nargs="+", default=RATES)
parser.add_argument("--two-rates", type=float, nargs="+", default=[1e-4, 1e-3])
parser.add_argument("--laws", nargs="+", default=["norton"], choices=["norton", "bilin"], help="of part two")
parser.add_argument("--fem", type=pathlib.Path)
options = parser.parse_args()
tools = options.bin.resolve()
options.folder.mkdir(parents=True, exist_ok=True)
packings = range(1, options.packings + 1)
size = options.particles
numbers, lines = {}, []


def tool(name, *words):
    one_thread = ["--threads", "1"] if json.loads(subprocess.check_output([tools / name, "--describe"]))["threads"] else []
    subprocess.run([str(tools / name), *map(str, words), "--quiet", *one_thread], check=True)


def brick(packing):
    path = options.folder / f"brick-{size}-{packing}.h5"
    if not path.exists():
        tool("packgen", path, "--particles", size, "--density", 0.64, "--random-seed", packing)
    return path


def run(name, sample, text):
    """The curves of a run, done if it is not there: strain (positive along the load), true stress in MPa, error, heat."""
    scene, result = options.folder / f"{name}.toml", options.folder / f"{name}.h5"
    scene.write_text(text)
    if not result.exists():
        tool("solve", sample, scene, result, "--json", options.folder / f"{name}.json", "--checkpoint-every", 0)
    with h5py.File(result) as file:
        get = lambda key: file[f"observables/{key}/value"][:]
        sign = np.sign(get("strain")[-1])
        return {"strain": sign * get("strain"), "stress": sign * get("stress_true") / 1e6,
                "error": get("equilibrium_error"), "file": result,
                "summary": json.loads((options.folder / f"{name}.json").read_text())}


def mean(curve, at, half=WINDOW, key="stress"):
    return curve[key][np.abs(curve["strain"] - at) <= half].mean()


def volume(curve, at):
    table = curve["file"].with_suffix(".volume.csv")
    if not table.exists():
        tool("volume_change", curve["file"], table)
    with open(table) as file:
        rows = list(csv.DictReader(file))
    strains = [abs(float(row["strain [-]"])) for row in rows]
    return float(np.interp(at, strains, [float(row["volume_change [-]"]) for row in rows]))


def keep(key, values):
    numbers[key] = {"mean": float(np.mean(values)), "spread": float(np.std(values, ddof=1)) if len(values) > 1 else 0.0,
                    "values": [float(value) for value in values]}
    return numbers[key]


def pm(values, form):
    found = f"{np.mean(values):{form}}"
    return found + (f" ± {np.std(values, ddof=1):{form.lstrip('+')}}" if len(values) > 1 else "")


def table(title, *columns):
    lines.extend(["", title, "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)])


def row(*cells):
    lines.append("| " + " | ".join(cells) + " |")


def load(strain, rate, accuracy=""):
    return f"[load]\nsteps = [ {{ strain = {strain}, rate = {rate:g} }} ]\n[accuracy]\nscheme = \"explicit\"\nframes = 6\n{accuracy}"


def draw(curves):
    """Stress over K rate^M against strain of every exponent at the fastest rate, all packings."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    for axis, direction in zip(axes, ("compression", "tension")):
        for k, exponent in enumerate(options.exponents):
            for packing in packings:
                curve = curves[exponent, direction, packing]
                axis.plot(curve["strain"][1:], curve["stress"][1:] / (K * options.rates[0]**exponent), color=f"C{k}", lw=0.8,
                          label=f"M = {exponent:g}" if packing == 1 else None)
        axis.axhline(1, color="black", lw=0.5)
        axis.set(title=direction, xlabel="true strain", ylim=(0, 1.4))
    axes[0].set_ylabel("true stress over K rate$^M$")
    axes[0].legend()
    figure.savefig(options.folder / "curves.png", dpi=130)


def one():
    every = {}
    table(f"One phase, {size} particles: stress over K rate^M at strain 0.3, constants of 1e-3 /s at every rate", "M", "load",
          *(f"{rate:g} /s" for rate in options.rates), "M fitted", "at 0.15, 0.5 (fastest)", "volume at 0.5, fastest, slowest",
          "equilibrium error", "steps to 0.3")
    for exponent in options.exponents:
        curves = {}
        for direction, sign in (("compression", -1), ("tension", 1)):
            for rate in options.rates:
                for packing in packings:
                    curves[direction, rate, packing] = run(
                        f"one-{size}-{packing}-{exponent:g}-{rate:g}-{direction}", brick(packing),
                        phase("a", 1, (K, exponent)) + load(sign * 0.55, rate, f"reference_rate = {RATES[0]:g}\n"))
                    if rate == options.rates[0]:
                        every[exponent, direction, packing] = curves[direction, rate, packing]
            ratio = {rate: [mean(curves[direction, rate, p], 0.3) / (K * rate**exponent) for p in packings]
                     for rate in options.rates}
            fits = [np.polyfit(np.log(options.rates), [np.log(ratio[rate][p - 1] * rate**exponent) for rate in options.rates], 1)[0]
                    for p in packings] if len(options.rates) > 1 else [math.nan]
            key = f"{exponent:g} {direction}"
            for rate in options.rates:
                keep(f"{key} {rate:g} ratio", ratio[rate])
            keep(f"{key} M", fits)
            fast, slow = options.rates[0], options.rates[-1]
            volumes = {rate: [volume(curves[direction, rate, p], 0.5) for p in packings] for rate in (fast, slow)}
            keep(f"{key} fast volume", volumes[fast])
            keep(f"{key} slow volume", volumes[slow])
            others = [np.mean([mean(curves[direction, fast, p], at) for p in packings]) / (K * fast**exponent) for at in (0.15, 0.5)]
            errors = [mean(curves[direction, fast, p], 0.3, key="error") for p in packings]
            summary = curves[direction, fast, 1]["summary"]
            row(f"{exponent:g}", direction, *(pm(ratio[rate], ".3f") for rate in options.rates), pm(fits, ".3f"),
                f"{others[0]:.3f}, {others[1]:.3f}",
                ", ".join(f"{100 * np.mean(volumes[rate]):+.1f} %" for rate in (fast, slow)), f"{np.mean(errors):.2%}",
                f"{0.3 / (fast * summary['time_step']):.0f}")
        for rate in options.rates:
            keep(f"{exponent:g} {rate:g} T/C", [mean(curves["tension", rate, p], 0.3) / mean(curves["compression", rate, p], 0.3)
                                              for p in packings])
        print("\n".join(lines[-2:]), flush=True)
    draw(every)


def jump():
    table(f"Rate times 3 at strain 0.2, {size} particles: log3 of the stress over 0.31 to 0.36 against the run without jump, "
          "constants and mass of the fast rate in both", "M", "answered with")
    for exponent in options.exponents:
        answers = []
        for packing in packings:
            text = phase("a", 1, (K, exponent))
            accuracy = "[accuracy]\nscheme = \"explicit\"\nframes = 1\ninertia_share = 0.003\nreference_rate = 3e-3\n"
            steps = ["{ strain = -0.2, rate = 1e-3 }, { strain = -0.37, rate = 3e-3 }",
                     "{ strain = -0.37, rate = 1e-3 }, { strain = -0.371, rate = 3e-3 }"]
            with_jump, without = (run(f"jump-{size}-{packing}-{exponent:g}-{k}", brick(packing),
                                      f"{text}[load]\nsteps = [ {one} ]\n{accuracy}") for k, one in enumerate(steps))
            answers.append(math.log(mean(with_jump, 0.335, 0.025) / mean(without, 0.335, 0.025)) / math.log(3))
        keep(f"{exponent:g} jump", answers)
        row(f"{exponent:g}", pm(answers, ".3f"))
        print(lines[-1], flush=True)


def step():
    table(f"Half the time step, {size} particles, one packing: stress at 0.3", "M", "change")
    for exponent in options.exponents:
        text = phase("a", 1, (K, exponent))
        whole = run(f"step-{size}-{exponent:g}-1", brick(1), text + load(-0.36, 1e-3))
        half = run(f"step-{size}-{exponent:g}-2", brick(1),
                   text + load(-0.36, 1e-3, f"time_step = {whole['summary']['time_step'] / 2:.12g}\n"))
        change = mean(half, 0.3) / mean(whole, 0.3) - 1
        keep(f"{exponent:g} half", [change])
        row(f"{exponent:g}", f"{change:+.3%}")
        print(lines[-1], flush=True)


def labelled(packing, case):
    """The brick with phase B (label 2) where the case has it."""
    path = options.folder / f"{case}-{size}-{packing}.h5"
    if path.exists():
        return path
    shutil.copy(brick(packing), path)
    samples.label(path, case)
    return path


def two():
    table(f"Two phases at strain 0.3, {size} particles, the same packings", "case", "rate [1/s]", "law",
          "engineering stress [MPa]", "finite elements", "difference", "S_f", "finite elements", "difference")
    for case in ("parallel", "series", "inclusion"):
        for rate in options.two_rates:
            power = {1e-3: "1e-3", 1e-4: "1e-4", 2.15e-4: "2.15e-4", 4.64e-4: "4.64e-4"}[rate]
            suffix = "" if case == "inclusion" else "_fB0.5"
            wanted = samples.reference(options.fem, f"{case}_stress_strain_rate{power}{suffix}.csv", 0.3) if options.fem else math.nan
            for law in options.laws:
                both = (phase("a", 1, PHASES["A"]) + phase("b", 2, PHASES["B"])).replace('"norton"', f'"{law}"')
                curves = [run(f"two-{law}-{case}-{size}-{p}-{rate:g}", labelled(p, case), both + load(-0.32, rate))
                          for p in packings]
                stresses = [mean(curve, 0.3, 0.02) * math.exp(0.3) for curve in curves]
                key = f"{law} {case} {rate:g}"
                keep(f"{key} stress", [value / wanted - 1 for value in stresses])
                cells = ["-"] * 3
                if case == "inclusion":
                    shapes = [samples.shape(curve["file"], curve["strain"][-1], 0.3) for curve in curves]
                    true = samples.reference(options.fem, f"inclusion_shape_factor_rate{power}.csv", 0.3) if options.fem else math.nan
                    keep(f"{key} shape", [value / true - 1 for value in shapes])
                    cells = [pm(shapes, ".3f"), f"{true:.3f}", f"{np.mean(shapes) / true - 1:+.1%}"]
                row(case, f"{rate:g}", law.upper(), pm(stresses, ".1f"), f"{wanted:.1f}",
                    f"{np.mean(stresses) / wanted - 1:+.1%}", *cells)
                print(lines[-1], flush=True)


for part in options.parts:
    {"one": one, "jump": jump, "step": step, "two": two}[part]()
text = "\n".join(lines).lstrip()
print("\n" + text)
(options.folder / "tables.md").write_text(text + "\n")
(options.folder / "tables.json").write_text(json.dumps(numbers, indent=1))
