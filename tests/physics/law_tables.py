#!/usr/bin/python3
"""Flow stress, Norton law, volume, equilibrium, necking and rupture of BILIN and TRILIN, beside the thesis' figures.

usage: law_tables.py BIN [--folder law_tables] [--laws bilin trilin cost] [--particles 5000 50000] [--packings 3]
                         [--quick] [--tables]

Packs, relaxes and presses every sample with the executables in BIN, then prints the tables and writes curves.png,
tables.json and tables.md into the folder. A finished run stays there and is not done again. Runs go one after the
other, those that make a table of small samples first.
  --quick    5,000 particles, larger steps, no slowest rate of TRILIN, no cost table: minutes
  --tables   tables of the runs that are finished, without a new one
"""
import argparse
import csv
import dataclasses
import json
import os
import subprocess
import sys
import time

import h5py
import numpy as np

THESIS_TIME_STEP = 5e-4  # s, of phases A and B: cost factor 1
BILIN_RATES = [1e-4, 3.16e-4, 1e-3]
TRILIN_RATES = [3.16e-5, 3.16e-4, 3.16e-3]
DENSITIES = {"bilin": {2000: 0.70, 5000: 0.70, 50000: 0.65}, "trilin": {5000: 0.74, 50000: 0.74}}
THESIS = {"A": {"K": 95.9, "M": 2.45e-3}, "B": {"K": 5020.0, "M": 0.490}, "TRILIN": {"K": 49.1, "M": 7.14e-2}}
FLOW_STRAIN, HALF_WINDOW = 0.30, 0.05  # of the flow stress
SEATING = 0.06  # strain of pressing before pulling: the planes hold a relaxed, rough face by few particles
SMOOTHING = 0.06  # strain, of the tension curve whose fall is looked at
NECK, RUPTURE = 0.85, 0.02  # of the highest stress

PHASES = {
    "A": """law = "bilin"
repulsive_stiffness = 6.23e9
stiffness_ratio = 10""",
    "B": """law = "bilin"
repulsive_stiffness = 2.65e9
stiffness_ratio = 10""",
    "TRILIN": """law = "trilin"
repulsive_stiffness = 1.42e9
stiffness_ratio = 3
greatest_attraction = 1.0e8""",
}


@dataclasses.dataclass(frozen=True)
class Run:
    """One sample under one load: pressed by `seating` if that is not 0, then to `strain`, negative in compression."""

    phase: str
    particles: int
    packing: int
    rate: float
    strain: float
    cost_factor: float = 1.0
    frames: int = 7
    seating: float = 0.0

    @property
    def law(self):
        return "trilin" if self.phase == "TRILIN" else "bilin"

    @property
    def time_step(self):
        return 0.1 if self.law == "trilin" else THESIS_TIME_STEP * self.cost_factor

    @property
    def natural_period(self):
        """The thesis', and what keeps rate t0^2 / time_step; A is on the plateau, where only stability counts."""
        if self.law == "trilin":
            return 1.0
        if self.phase == "A":
            return 1e-2 * self.cost_factor
        return 0.8 * self.cost_factor**0.5

    @property
    def density(self):
        return DENSITIES[self.law][self.particles]

    @property
    def name(self):
        return (f"{self.phase}-{self.particles}-{self.packing}-{self.rate:g}-{self.strain:+g}"
                + (f"-s{self.cost_factor:.4g}" if self.law == "bilin" else "")
                + (f"-seated{self.seating:g}" if self.seating else ""))

    def scene(self):
        targets = ([-self.seating] if self.seating else []) + [self.strain]
        steps = ", ".join(f"{{ strain = {strain}, rate = {self.rate} }}" for strain in targets)
        return f"""seed_radius = 0.5
crown_radius = {0.70 if self.law == "trilin" else 0.75}
[phase.{self.phase}]
label = 1
{PHASES[self.phase]}
natural_period = {self.natural_period!r}
[load]
steps = [ {steps} ]
[accuracy]
time_step = {self.time_step!r}
frames = {self.frames}
"""


def bilin_run(phase, particles, packing, rate, strain_per_step):
    # A's period follows its time step, so on the plateau a run depends on rate * time_step alone: only one set of
    # constants at all rates says anything about M.
    greatest_rate = max(BILIN_RATES) if phase == "A" else rate
    factor = strain_per_step / (greatest_rate * THESIS_TIME_STEP)
    return Run(phase, particles, packing, rate, -0.35, factor)


def pressed(particles, packing, rate):
    return Run("TRILIN", particles, packing, rate, -1.0, frames=10)


def pulled(particles, packing, rate, seating=SEATING):
    return Run("TRILIN", particles, packing, rate, 1.2, frames=22 if seating else 20, seating=seating)


def cost_run(phase, packing, factor):
    return Run(phase, 2000, packing, 1e-3, -0.35, float(factor))


def plan(request):
    """Every run, in the order in which they are done: small and fast ones first, one packing before the others."""
    packings = range(1, request.packings + 1)
    step = 2.5e-5  # strain in a time step at the greatest rate
    small, cost, fast, slow, slowest = [], [], [], [], []
    for rate in reversed(BILIN_RATES):
        small += [bilin_run("B", 5000, p, rate, step if request.quick else 5e-6) for p in packings]
        small += [bilin_run("A", 5000, p, rate, step) for p in packings]
    for rate in (3.16e-3, 3.16e-4):
        small += [run for p in packings for run in (pressed(5000, p, rate), pulled(5000, p, rate))]
        small += [pulled(5000, p, rate, seating=0.0) for p in packings]
    if not request.quick:
        cost = [cost_run(phase, p, factor) for phase in "BA" for factor in (50, 10) for p in packings]
        cost += [cost_run("B", 1, 1), cost_run("A", 1, 1)]
        for p in packings:
            fast.append([bilin_run("A", 50000, p, 1e-3, step), pressed(50000, p, 3.16e-3), pulled(50000, p, 3.16e-3),
                         *(bilin_run("B", 50000, p, rate, step) for rate in reversed(BILIN_RATES))])
            slow.append([pressed(5000, p, 3.16e-5), pulled(5000, p, 3.16e-5),
                         pulled(50000, p, 3.16e-3, seating=0.0), pressed(50000, p, 3.16e-4), pulled(50000, p, 3.16e-4)])
            slowest.append([bilin_run("A", 50000, p, 3.16e-4, step), bilin_run("A", 50000, p, 1e-4, step),
                            *(Run("A", 5000, p, rate, -0.35, 10.0) for rate in reversed(BILIN_RATES))])
        slowest.append([Run("TRILIN", 50000, 1, 3.16e-5, -0.4, frames=4),
                        Run("TRILIN", 50000, 1, 3.16e-5, 0.4, frames=4, seating=SEATING)])
    stages = [small, cost, *fast[:1], *slow[:1], *fast[1:], *slow[1:], *slowest]
    return [run for stage in stages for run in stage
            if ("cost" if run.particles == 2000 else run.law) in request.laws
            and run.particles in (2000, *request.particles)]


class Workshop:
    """The executables and the folder in which finished files are kept."""

    def __init__(self, bin_folder, folder):
        self.bin, self.folder = os.path.abspath(bin_folder), folder
        os.makedirs(folder, exist_ok=True)

    def file(self, name):
        return os.path.join(self.folder, name)

    def tool(self, name, *arguments):
        program = os.path.join(self.bin, name)
        one_thread = ["--threads", "1"] if json.loads(subprocess.check_output([program, "--describe"]))["threads"] else []
        subprocess.run([program, *arguments, "--quiet", *one_thread], check=True)

    def done(self, run):
        return os.path.exists(self.file(run.name + ".volume.csv"))

    def perform(self, run):
        scene = self.file(run.name + ".toml")
        with open(scene, "w") as file:
            file.write(run.scene())
        sample = self.relaxed(run, scene)
        result = self.file(run.name + ".h5")
        if not os.path.exists(result):
            self.tool("solve", sample, scene, result, "--json", self.file(run.name + ".json"))
        self.tool("volume_change", result, self.file(run.name + ".volume.csv"))

    def relaxed(self, run, scene):
        """Relaxation does not look at rate, period and time step: one for a phase and a packing."""
        brick = self.file(f"brick-{run.particles}-{run.density}-{run.packing}.h5")
        sample = self.file(f"{run.phase}-{run.particles}-{run.packing}.relaxed.h5")
        if not os.path.exists(brick):
            self.tool("packgen", brick, "--particles", str(run.particles), "--density", str(run.density),
                      "--random-seed", str(run.packing))
        if not os.path.exists(sample):
            self.tool("relax", brick, scene, sample)
        return sample


class Curve:
    """What a finished run says. Stresses in MPa, positive along the load."""

    def __init__(self, shop, run):
        self.run = run
        with h5py.File(shop.file(run.name + ".h5")) as file:
            values = {key: file[f"observables/{key}/value"][:]
                      for key in ("strain", "stress_true", "equilibrium_error")}
        with open(shop.file(run.name + ".volume.csv")) as file:
            rows = list(csv.DictReader(file))
        self.volume = np.array([float(row["volume_change [-]"]) for row in rows])
        frames = np.array([float(row["strain [-]"]) for row in rows])
        sign = np.sign(run.strain)
        kept, after = (values["strain"] * sign > 0, frames * sign >= -1e-9)
        self.strain = np.abs(values["strain"][kept])
        self.stress = values["stress_true"][kept] / 1e6 * sign
        self.error = values["equilibrium_error"][kept]
        self.frame_strain, self.volume = np.abs(frames[after]), self.volume[after]

    def between(self, values, at=FLOW_STRAIN, half=HALF_WINDOW):
        return values[np.abs(self.strain - at) <= half].mean()

    def flow(self):
        return self.between(self.stress)

    def equilibrium(self):
        return self.between(self.error)

    def volume_at(self, strain):
        return float(np.interp(strain, self.frame_strain, self.volume, right=np.nan))

    def smoothed(self):
        points = max(1, int(round(SMOOTHING / (self.strain[-1] / len(self.strain)))))
        return np.convolve(self.stress, np.ones(points) / points, mode="same")

    def fall(self, share):
        """First strain after the peak at which the smoothed stress is below a share of it; nan if it never is."""
        stress = self.smoothed()
        peak = int(np.argmax(stress))
        below = self.strain[peak:][stress[peak:] < share * stress[peak]]
        # The window of the last points reaches beyond the curve.
        return below[0] if len(below) and below[0] < self.strain[-1] - SMOOTHING else np.nan


class Tables:
    """Tables as text and as numbers, from the runs that are finished."""

    def __init__(self, shop, runs):
        self.shop = shop
        self.curves = {run: Curve(shop, run) for run in runs if shop.done(run)}
        self.lines, self.numbers = [], {}

    def write(self):
        self.bilin()
        self.cost()
        self.trilin()
        self.ends()
        text = "\n".join(self.lines)
        print(text)
        with open(self.shop.file("tables.md"), "w") as file:
            file.write(text + "\n")
        with open(self.shop.file("tables.json"), "w") as file:
            json.dump(self.numbers, file, indent=1)

    def table(self, title, *columns):
        self.lines += ["", title, "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]

    def row(self, *cells):
        self.lines.append("| " + " | ".join(cells) + " |")

    def keep(self, key, values):
        """Mean, spread and number, under a name."""
        self.numbers[key] = {"mean": float(np.mean(values)), "spread": spread(values),
                             "values": [float(value) for value in values]}

    def group(self, **wanted):
        return [curve for run, curve in self.curves.items()
                if all(getattr(run, key) == value for key, value in wanted.items())]

    def norton(self, groups):
        """K and M of each packing that has every rate, by norton_fit."""
        fits = []
        packings = sorted({curve.run.packing for group in groups for curve in group})
        for packing in packings:
            runs = [curve.run for group in groups for curve in group if curve.run.packing == packing]
            if len(runs) < len(groups) or len(runs) < 2:
                continue
            table, report = self.shop.file("norton.csv"), self.shop.file("norton.json")
            self.shop.tool("norton_fit", *(self.shop.file(run.name + ".h5") for run in runs), table, "--at",
                           str(FLOW_STRAIN), "--window", str(HALF_WINDOW), "--json", report)
            with open(report) as file:
                fit = json.load(file)
            fits.append((fit["K"], fit["M"]))
        return np.array(fits).reshape(-1, 2)

    def norton_line(self, key, label, groups):
        fits = self.norton([group for group in groups if group])
        if len(fits):
            wanted = THESIS[key.split()[0]]
            self.keep(key + " K", fits[:, 0])
            self.keep(key + " M", fits[:, 1])
            rates = sum(bool(group) for group in groups)
            self.lines.append("")
            self.lines.append(f"{label}: M = {pm(fits[:, 1], '.4f')} (thesis {wanted['M']:g}), "
                              f"K = {pm(fits[:, 0], '.4g')} MPa.s^M (thesis {wanted['K']:g}); "
                              f"{rates} rates, {len(fits)} packing{'s' if len(fits) > 1 else ''}")

    def bilin(self):
        for particles in (5000, 50000):
            factors = sorted({run.cost_factor for run in self.curves if run.phase == "A"})
            for phase, factor in [*(("A", factor) for factor in factors), ("B", None)]:
                same = {} if factor is None else {"cost_factor": factor}
                groups = [self.group(phase=phase, particles=particles, rate=rate, **same) for rate in BILIN_RATES]
                if not any(groups):
                    continue
                name = f"{phase} {particles}" + (f" s{factor:g}" if factor else "")
                self.table(f"BILIN, phase {phase}, {particles} particles, D = {DENSITIES['bilin'][particles]}",
                           "rate [1/s]", "s", "packings", "flow stress at 0.3 [MPa]", "thesis", "equilibrium error",
                           "volume at 0.3")
                for rate, group in zip(BILIN_RATES, groups):
                    if not group:
                        continue
                    stresses = [curve.flow() for curve in group]
                    key = f"{name} {rate:g}"
                    self.keep(key + " stress", stresses)
                    self.keep(key + " equilibrium", [curve.equilibrium() for curve in group])
                    self.keep(key + " volume", [curve.volume_at(0.3) for curve in group])
                    self.row(f"{rate:g}", f"{group[0].run.cost_factor:.3g}", f"{len(group)}", pm(stresses, ".1f"),
                             f"{norton(THESIS[phase], rate):.1f}",
                             f"{np.mean([curve.equilibrium() for curve in group]):.3%}",
                             percent([curve.volume_at(0.3) for curve in group]))
                self.norton_line(name, f"phase {phase}, {particles} particles", groups)

    def cost(self):
        runs = sorted({(run.phase, run.cost_factor) for run in self.curves if run.particles == 2000})
        if not runs:
            return
        self.table("Cost factor s, 2000 particles, D = 0.70, 1e-3 /s", "phase", "s", "time steps", "packings",
                   "flow stress at 0.3 [MPa]", "over that at s = 10, same packing", "equilibrium error",
                   "volume at 0.3")
        for phase, factor in runs:
            reference = {curve.run.packing: curve.flow()
                         for curve in self.group(phase=phase, particles=2000, cost_factor=10)}
            group = self.group(phase=phase, particles=2000, cost_factor=factor)
            self.keep(f"{phase} 2000 s{factor:g} stress", [curve.flow() for curve in group])
            self.row(phase, f"{factor:g}", f"{0.35 / (1e-3 * group[0].run.time_step):.0f}", f"{len(group)}",
                     pm([curve.flow() for curve in group], ".1f"),
                     pm([curve.flow() / reference.get(curve.run.packing, np.nan) for curve in group], ".3f"),
                     f"{np.mean([curve.equilibrium() for curve in group]):.3%}",
                     percent([curve.volume_at(0.3) for curve in group]))

    def trilin_loads(self, particles, rate):
        """Pressed, pulled after a seating, pulled as they are."""
        group = self.group(phase="TRILIN", particles=particles, rate=rate)
        return ([curve for curve in group if curve.run.strain < 0],
                [curve for curve in group if curve.run.strain > 0 and curve.run.seating],
                [curve for curve in group if curve.run.strain > 0 and not curve.run.seating])

    def trilin(self):
        for particles in (5000, 50000):
            loads = [self.trilin_loads(particles, rate) for rate in TRILIN_RATES]
            if not any(pressed for pressed, _, _ in loads):
                continue
            self.table(f"TRILIN at strain {FLOW_STRAIN}, {particles} particles, D = {DENSITIES['trilin'][particles]}; "
                       f"tension after pressing by {SEATING}", "rate [1/s]", "packings", "compression [MPa]",
                       "tension [MPa]", "tension / compression", "thesis [MPa]", "equilibrium error, compression",
                       "tension", "volume, compression", "tension")
            for rate, (pressed, pulled, _) in zip(TRILIN_RATES, loads):
                if not pressed:
                    continue
                c = {curve.run.packing: curve.flow() for curve in pressed}
                t = {curve.run.packing: curve.flow() for curve in pulled}
                ratios = [t[packing] / c[packing] for packing in t if packing in c]
                key = f"TRILIN {particles} {rate:g}"
                self.keep(f"{key} compression", list(c.values()))
                if t:
                    self.keep(f"{key} tension", list(t.values()))
                    self.keep(f"{key} ratio", ratios)
                self.row(f"{rate:g}", f"{len(pressed)}, {len(pulled)}", pm(list(c.values()), ".1f"),
                         pm(list(t.values()), ".1f"), pm(ratios, ".2f"), f"{norton(THESIS['TRILIN'], rate):.1f}",
                         *(f"{np.mean([curve.equilibrium() for curve in group]):.2%}" if group else "-"
                           for group in (pressed, pulled)),
                         *(percent([curve.volume_at(FLOW_STRAIN) for curve in group]) for group in (pressed, pulled)))
            for name, column in (("compression", 0), ("tension", 1)):
                self.norton_line(f"TRILIN {particles} {name}", f"TRILIN, {particles} particles, {name}",
                                 [load[column] for load in loads])
            self.mean_of_both(particles, loads)

    def mean_of_both(self, particles, loads):
        """Norton's law through the mean of tension and compression, which is what the thesis states."""
        stresses = {}
        for rate, load in zip(TRILIN_RATES, loads):
            for pressed in load[0]:
                for pulled in load[1]:
                    if pressed.run.packing == pulled.run.packing:
                        mean = (pressed.flow() + pulled.flow()) / 2
                        stresses.setdefault(pressed.run.packing, []).append((rate, mean))
        most = max(map(len, stresses.values()), default=0)
        if most < 2:
            return
        fits = np.array([np.polyfit(*np.log(points).T, 1) for points in map(np.array, stresses.values())
                         if len(points) == most])
        wanted = THESIS["TRILIN"]
        self.keep(f"TRILIN {particles} mean M", fits[:, 0])
        self.keep(f"TRILIN {particles} mean K", np.exp(fits[:, 1]))
        self.lines.append("")
        self.lines.append(f"TRILIN, {particles} particles, mean of both: M = {pm(fits[:, 0], '.4f')} (thesis "
                          f"{wanted['M']:g}), K = {pm(np.exp(fits[:, 1]), '.4g')} MPa.s^M (thesis {wanted['K']:g}); "
                          f"{most} rates, {len(fits)} packing{'s' if len(fits) > 1 else ''}")

    def ends(self):
        keys = sorted({(run.particles, run.rate) for run in self.curves if run.phase == "TRILIN"})
        if not keys:
            return
        self.table(f"TRILIN pulled apart: strains at which the stress falls below {NECK} (necking) and {RUPTURE} "
                   "(rupture) of its highest", "particles", "rate [1/s]", "pressed first by", "packings",
                   "highest stress [MPa]", "necking", "rupture", "volume at 0.4", "volume at 1")
        for particles, rate in keys:
            for group in self.trilin_loads(particles, rate)[1:]:
                group = [curve for curve in group if curve.run.strain > 0.5]
                if not group:
                    continue
                seating = group[0].run.seating
                key = f"TRILIN {particles} {rate:g} {'seated' if seating else 'straight'}"
                self.keep(key + " peak", [curve.smoothed().max() for curve in group])
                self.keep(key + " necking", [curve.fall(NECK) for curve in group])
                self.keep(key + " rupture", [curve.fall(RUPTURE) for curve in group])
                self.row(f"{particles}", f"{rate:g}", f"{seating:g}", f"{len(group)}",
                         pm([curve.smoothed().max() for curve in group], ".1f"),
                         pm([curve.fall(NECK) for curve in group], ".2f"),
                         pm([curve.fall(RUPTURE) for curve in group], ".2f"),
                         *(percent([curve.volume_at(at) for curve in group]) for at in (0.4, 1.0)))
        self.table("TRILIN pressed to large strain", "particles", "rate [1/s]", "packings", "stress at 0.3 [MPa]",
                   "0.6", "0.9", "volume at 0.3", "0.6", "0.9")
        for particles, rate in keys:
            group = [curve for curve in self.trilin_loads(particles, rate)[0] if curve.run.strain < -0.5]
            if group:
                self.row(f"{particles}", f"{rate:g}", f"{len(group)}",
                         *(pm([curve.between(curve.stress, at) for curve in group], ".1f") for at in (0.3, 0.6, 0.9)),
                         *(percent([curve.volume_at(at) for curve in group]) for at in (0.3, 0.6, 0.9)))

    def picture(self, name):
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        colours = {rate: f"C{i}" for i, rate in enumerate([1e-4, 3.16e-4, 1e-3, 3.16e-5, 3.16e-3])}
        sizes = [size for size in (5000, 50000) if self.group(particles=size)]
        figure, axes = pyplot.subplots(max(1, len(sizes)), 3, figsize=(15, 4 * max(1, len(sizes))), squeeze=False,
                                       constrained_layout=True)
        for row, particles in zip(axes, sizes):
            for axis, phase in zip(row, PHASES):
                group = self.group(phase=phase, particles=particles)
                for curve in group:
                    straight = curve.run.strain > 0 and not curve.run.seating
                    axis.plot(curve.strain, np.sign(curve.run.strain) * curve.stress, lw=0.8,
                              ls=":" if straight else "-", color=colours[curve.run.rate])
                rates = sorted({curve.run.rate for curve in group})
                for rate in rates:
                    wanted = norton(THESIS[phase], rate)
                    for value in (wanted, -wanted) if phase == "TRILIN" else (-wanted,):
                        axis.axhline(value, ls="--", lw=1, color=colours[rate])
                    axis.plot([], [], color=colours[rate], label=f"{rate:g} /s")
                if any(curve.run.seating for curve in group):
                    axis.plot([], [], ":", color="k", label="not pressed first")
                axis.set_title(f"{phase if phase == 'TRILIN' else 'BILIN ' + phase}, {particles} particles")
                axis.set_xlabel("|true strain|")
                axis.set_ylabel("true stress [MPa] (dashed: thesis)")
                if phase == "TRILIN":
                    axis.set_ylim(-45, 65)
                if rates:
                    axis.legend(loc="upper right", ncols=2 if phase == "TRILIN" else 1)
        figure.savefig(name, dpi=110)


def norton(law, rate):
    return law["K"] * rate ** law["M"]


def spread(values):
    return float(np.std(values, ddof=1)) if len(values) > 1 else 0.0


def pm(values, form):
    """Mean +- standard deviation; a value that is missing is counted, not averaged."""
    present = [value for value in values if not np.isnan(value)]
    if not present:
        return "not reached" if len(values) else "-"
    text = f"{np.mean(present):{form}}"
    if len(present) > 1:
        text += f" ± {spread(present):{form.lstrip('+')}}"
    missing = len(values) - len(present)
    return text + (f" ({missing} of {len(values)} not reached)" if missing else "")


def percent(values):
    text = pm([100 * value for value in values], "+.1f")
    return text + " %" if text[-1].isdigit() else text


def main():
    purpose, usage, text = __doc__.split("\n\n", 2)
    parser = argparse.ArgumentParser(usage=usage.removeprefix("usage: "), description=f"{purpose}\n\n{text}",
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", help="folder of the executables")
    parser.add_argument("--folder", default="law_tables")
    parser.add_argument("--laws", nargs="+", choices=["bilin", "trilin", "cost"], default=["bilin", "trilin", "cost"])
    parser.add_argument("--particles", nargs="+", type=int, choices=[5000, 50000], default=[5000, 50000])
    parser.add_argument("--packings", type=int, default=3)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--tables", action="store_true")
    request = parser.parse_args()

    shop = Workshop(request.bin, request.folder)
    runs = plan(request)
    failed = []
    for number, run in enumerate(runs, 1):
        if not request.tables and not shop.done(run):
            start = time.monotonic()
            outcome = ""
            try:
                shop.perform(run)
            except subprocess.CalledProcessError as error:
                failed.append(run.name)
                outcome = f" FAILED: {os.path.basename(error.cmd[0])} ended with status {error.returncode}"
            seconds = time.monotonic() - start
            print(f"{number}/{len(runs)} {run.name}: {seconds:.0f} s{outcome}", file=sys.stderr, flush=True)
    tables = Tables(shop, runs)
    tables.write()
    tables.picture(shop.file("curves.png"))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
