"""The folder of a bench of NORTON: samples and runs that are made once, and the tables of what they show.

A file is not made again while its executable, the contents of its inputs and its options stay what they were; a new build
of an executable makes its files again.
"""
import argparse
import csv
import dataclasses
import hashlib
import json
import os
import pathlib
import resource
import shutil
import subprocess

import h5py
import numpy as np

import samples

HALF_WINDOW = 0.02  # of strain: a stress "at" a strain is the mean over that much on each side
RELAXATION_RATE = 1e-3  # 1/s
STRESSES = {"planes": "stress_true", "virial": "stress_virial"}  # and their curves in a run; older runs lack the second


@dataclasses.dataclass(frozen=True)
class Load:
    """What is done to a sample, as in a scene. `steps` are (true strain, rate in 1/s); `accuracy` are further lines."""
    steps: tuple
    scheme: str = "quasi_static"
    lateral: str = "free"
    frames: int = 10
    accuracy: str = ""
    walls: str = ""
    particle_stress: bool = False

    def scene(self, phases):
        steps = ", ".join(f"{{ strain = {strain:g}, rate = {rate:g} }}" for strain, rate in self.steps)
        return (f'{phases}{self.walls}[load]\nsteps = [ {steps} ]\nlateral = "{self.lateral}"\n'
                f'[output]\nstress = {str(self.particle_stress).lower()}\n'
                f'[accuracy]\nscheme = "{self.scheme}"\nframes = {self.frames}\n{self.accuracy}')


class Run:
    """The curves of a load, positive along it: `strain`, `stress["planes"]` and, where the run has it, `stress["virial"]`,
    true stresses in MPa. `stopped` is the message of a run that a guard ended; it has its curves up to there, and no file
    if that was at its first point."""

    def __init__(self, file, summary):
        self.file, self.summary, self.stopped = file, summary, summary.get("stopped")
        if not file.exists():  # stopped before its first point
            self.strain, self.stress, self.evaluations = np.zeros(1), {"planes": np.array([np.nan])}, None
            return
        with h5py.File(file) as run:
            get = lambda key: run[f"observables/{key}/value"][:]
            direction = np.sign(get("strain")[-1])
            self.strain = direction * get("strain")
            self.stress = {kind: direction * get(key) / 1e6 for kind, key in STRESSES.items()
                           if key in run["observables"]}
            self.evaluations = np.cumsum(get("evaluations")) if "evaluations" in run["observables"] else None

    def at(self, strain, kind="planes", half=HALF_WINDOW, scale=lambda strain: 1):
        """Mean over the window about a strain of a true stress times scale(strain); NaN beyond the end of the run."""
        points = np.linspace(strain - half, strain + half, 101)
        if self.strain[-1] < points[-1] - 1e-9:
            return np.nan
        return float((np.interp(points, self.strain, self.stress[kind]) * scale(points)).mean())

    def box_volume(self, strain):
        """Change of the volume between planes and periodic sides at a strain; NaN beyond the end of the run."""
        with h5py.File(self.file) as run:
            section = run["observables/section/value"][:]
            height = np.exp(run["observables/strain/value"][:])
        return float(np.interp(strain, self.strain, section / section[0] * height, right=np.nan) - 1)

    def deviator(self):
        """Strain and stress along z less the mean one across [MPa], from the stresses of the particles, of every frame but
        the first."""
        with h5py.File(self.file) as run:
            sums = run["particles/all/stress/value"][1:].mean(axis=1) / 1e6
            strain = np.interp(run["particles/all/position/time"][1:], run["observables/strain/time"][:], self.strain)
        return strain, np.abs(sums[:, 2] - (sums[:, 0] + sums[:, 1]) / 2)

    def neck(self, strain):
        """Smallest section over the mean one in the first frame at or after a strain (or the last), in eight slabs of the height between
        a tenth and nine tenths of it; a section is counted by its particles. NaN beyond the end of the run."""
        if self.strain[-1] < strain - 1e-9:
            return np.nan
        with h5py.File(self.file) as run:
            along = run["particles/all/position/value"][samples.frame_at(run, strain)][:, 2]
        height = (along - along.min()) / np.ptp(along)
        counts, _ = np.histogram(height, bins=8, range=(0.1, 0.9))
        return float(counts.min() / counts.mean())

    def evaluations_to(self, strain):
        return np.nan if self.evaluations is None else float(self.evaluations[self.strain <= strain + 1e-9][-1])


class Bench:
    """Makes samples and runs with the executables of a folder, and collects tables and figures."""

    def __init__(self, tools, folder, scheme="quasi_static"):
        self.tools, self.folder, self.scheme = tools.resolve(), folder, scheme
        folder.mkdir(parents=True, exist_ok=True)
        self.lines, self.numbers, self.stops, self.claims = [], {}, [], {}

    def made(self, tool, inputs, output, *words, processes=1):
        """Makes `output` unless it is there. @return the tool's summary, with `user_seconds` of all processes, and with
        `stopped`, the message, if solve ended before the load did"""
        executable, summary = self.tools / tool, output.with_suffix(".json")
        digest = hashlib.sha256(f"{processes} {words}".encode())
        for file in (executable, *inputs):
            digest.update(file.read_bytes())
        made_from = digest.hexdigest()
        if summary.exists() and json.loads(summary.read_text()).get("made_from") == made_from:
            return json.loads(summary.read_text())
        for stale in (summary, output):
            stale.unlink(missing_ok=True)
        mpi = ["mpirun", "--oversubscribe", "-n", str(processes)] if processes > 1 else []
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        ended = subprocess.run([*mpi, executable, *inputs, output, *map(str, words), "--quiet", "--json", summary],
                               capture_output=True, text=True, env=os.environ | {
                                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
        facts = {"made_from": made_from, "user_seconds": resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before}
        if ended.returncode != 0:
            if tool != "solve":
                raise SystemExit(f"{tool} failed at {output}:\n{ended.stderr}")
            partial = output.with_name(output.name + ".partial")
            if partial.exists():
                partial.replace(output)
            facts["stopped"] = next(line for line in ended.stderr.splitlines()[::-1] if line.startswith("solve:"))
        else:
            facts |= json.loads(summary.read_text())
        summary.write_text(json.dumps(facts, indent=1))
        return facts

    def brick(self, size, packing, case=None, share=None):
        """A cube of a dense packing, periodic; with phase B (label 2) where the case has it (samples.label)."""
        plain = self.folder / f"brick-{size}-{packing}.h5"
        self.made("packgen", [], plain, "--particles", size, "--density", 0.64, "--random-seed", packing, "--threads", 1)
        if case is None:
            return plain
        labelled = self.folder / f"{case}{share or ''}-{size}-{packing}.h5"
        shutil.copy(plain, labelled)
        samples.label(labelled, case, share)
        return labelled

    def relaxed(self, brick, phases, what, lateral="free"):
        """The brick at rest under the law; `what` names the phases."""
        rest = self.folder / f"{brick.stem}-{what}-{lateral}-{self.scheme}-rest.h5"
        scene = rest.with_suffix(".toml")
        scene.write_text(Load(((-0.3, RELAXATION_RATE),), self.scheme, lateral).scene(phases))
        self.made("relax", [brick, scene], rest)
        return rest

    def run(self, rest, phases, name, load, processes=1):
        """A load of a relaxed sample; `name` is what tells it from the other loads of that sample."""
        output = self.folder / f"{rest.stem.removesuffix('-rest')}-{name}.h5"
        scene = output.with_suffix(".toml")
        scene.write_text(load.scene(phases))
        run = Run(output, self.made("solve", [rest, scene], output, "--checkpoint-every", 0, processes=processes))
        if run.stopped:
            self.stops.append(f"{output.name}: {run.stopped}")
        return run

    def volume(self, run, strain):
        """Change of a run's volume at a strain, over that at the start: of the alpha shape, in which a surface that gets
        smooth counts, and inside the material. NaN beyond the run's end."""
        if run.strain[-1] < strain - 1e-9:
            return np.nan, np.nan
        table = run.file.with_suffix(".volume.csv")
        if not table.exists() or table.stat().st_mtime < run.file.stat().st_mtime:
            subprocess.run([self.tools / "volume_change", run.file, table, "--quiet"], check=True)
        with open(table) as file:
            rows = [(float(row["abs_strain [-]"]), float(row["volume_change [-]"])) for row in csv.DictReader(file)]
        return float(np.interp(strain, *zip(*rows))), samples.volume_inside(run.file, strain)

    def keep(self, key, values):
        """A figure of several packings, for the JSON file. @return the values"""
        values = np.array(values, float)
        self.numbers[key] = {"mean": float(np.mean(values)), "spread": spread(values), "values": values.tolist()}
        return values

    def claim(self, what, bound, where, value):
        """Notes a deviation that should not exceed a bound; write() lists the worst of each claim. NaN, a run that stopped,
        is the worst of all."""
        if not abs(value) < abs(self.claims.get(what, (0, 0, ""))[1]):
            self.claims[what] = (bound, value, where)

    def table(self, title, *columns):
        self.lines.extend(["", title, "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)])
        print("\n".join(self.lines[-4:]), flush=True)

    def row(self, *cells):
        self.lines.append("| " + " | ".join(map(str, cells)) + " |")
        print(self.lines[-1], flush=True)

    def write(self, name):
        """Writes name.md and name.json: the tables, the claims, runs that stopped, the figures."""
        self.table("Worst deviation of a mean over packings, and its bound", "what", "bound", "worst", "where", "")
        for what, (bound, worst, where) in self.claims.items():
            form = "+.2%" if "M fitted" not in what else "+.4f"
            self.row(what, f"{bound:{form.lstrip('+')}}", "stopped" if np.isnan(worst) else f"{worst:{form}}", where,
                     "met" if abs(worst) <= bound else "MISSED")
        if self.stops:
            self.lines.extend(["", "Runs that stopped:", "", *(f"- {stop}" for stop in dict.fromkeys(self.stops))])
            print("\n".join(self.lines[-len(self.stops) - 3:]))
        (self.folder / f"{name}.md").write_text("\n".join(self.lines).lstrip() + "\n")
        (self.folder / f"{name}.json").write_text(json.dumps(self.numbers, indent=1))


def spread(values):
    return float(np.std(values, ddof=1)) if len(values) > 1 else 0.0


def pm(values, form=".3f", suffix=""):
    """Mean ± standard deviation; "-" where a run ended before."""
    if np.isnan(values).any():
        return "-"
    found = f"{np.mean(values):{form}}"
    return found + (f" ± {spread(values):{form.lstrip('+')}}" if len(values) > 1 else "") + suffix


def percent(values, form="+.1f"):
    """pm() of shares, in per cent."""
    return pm(100 * np.asarray(values), form, " %")


def arguments(description, parts, sizes):
    """A parser with the options that the benches share. Sizes are (particles, packings)."""
    def size(text):
        particles, _, packings = text.partition("x")
        return int(particles), int(packings or 1)

    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path, help="folder of the executables")
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="of samples, runs and results")
    parser.add_argument("--parts", nargs="+", default=parts, choices=parts, metavar="PART", help=", ".join(parts))
    parser.add_argument("--samples", nargs="+", type=size, default=sizes, metavar="NxP", help="N particles, P packings")
    parser.add_argument("--scheme", default="quasi_static", choices=["quasi_static", "explicit"])
    return parser
