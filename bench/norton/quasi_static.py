#!/usr/bin/python3
"""What the quasi-static scheme of law NORTON costs: evaluations of the pair forces to strain 0.3 against the number of
particles and M, time beside the explicit scheme and BILIN, memory, and whether both schemes and any number of processes
give the same stress.

usage: quasi_static.py BIN [--folder FOLDER] [--particles 2000 10000 50000] [--packings 3]
                       [--exponents 0.03 0.1 0.3 0.5 1] [--parts count cost agree processes]
                       [--accuracy "key = value"] [--fem FOLDER] [--no-inclusion]

`count`: of one phase at each M and of the thesis' inclusion (a ball of 20 %, two phases), at the default force balance of
1e-2; from samples that were relaxed with the same scene, at D = 0.64. `cost`: user CPU at the largest size, the explicit
scheme to strain 0.01 only and scaled by its steps where that is more than 10,000 particles. `agree`: true stress of both
schemes from the same relaxed sample of the smallest size. `processes`: stress on 1, 2 and 4, likewise. Prints tables;
with --folder, writes them to tables.md there, keeps finished runs and does not do them again.
"""
import argparse
import json
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile

import h5py
import numpy as np

import samples
from samples import PHASES, phase

RATE = 1e-3
K = 100.0  # MPa.s^M of the single phase
STRAIN = 0.3
BILIN_STRAIN_STEP = 1e-5
WHOLE_EXPLICIT_RUN = 10000  # particles, at most
# An explicit force is a mean over the last averaging_strain, its section that of the end: with the usual 0.01 the stress
# is 0.6 % low, and the schemes seem to differ by that.
SHORT_WINDOW = 1e-3
EXPLICIT_SHARE = 0.01  # of strain, of a larger sample

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--folder", type=pathlib.Path, help="default: a temporary one")
parser.add_argument("--particles", type=int, nargs="+", default=[2000, 10000, 50000])
parser.add_argument("--packings", type=int, default=3)
parser.add_argument("--exponents", type=float, nargs="+", default=[0.03, 0.1, 0.3, 0.5, 1.0])
parser.add_argument("--parts", nargs="+", default=["count", "cost", "agree", "processes"])
parser.add_argument("--accuracy", default="", help="further keys of [accuracy] of part count, as max_imbalance = 1e-3")
parser.add_argument("--strain", type=float, default=STRAIN, help="of part count")
parser.add_argument("--no-inclusion", action="store_true")
parser.add_argument("--np", type=int, default=1, help="processes of part count")
parser.add_argument("--fem", type=pathlib.Path)
options = parser.parse_args()
tools = options.bin.resolve()
temporary = None if options.folder else tempfile.TemporaryDirectory()
options.folder = options.folder or pathlib.Path(temporary.name)
options.folder.mkdir(parents=True, exist_ok=True)
lines = []


def tool(name, *words, processes=1):
    """Runs an executable. @return its user CPU seconds, all processes"""
    few = ["--threads", str(processes)] if name == "packgen" else []
    mpi = ["mpirun", "--oversubscribe", "-np", str(processes)] if processes > 1 and name != "packgen" else []
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([*mpi, str(tools / name), *map(str, words), "--quiet", *few], check=True,
                   env=os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def timed(name, output, *words, processes=1):
    """The summary of a run of a tool, with user_seconds; done if its output is not there."""
    summary = output.with_suffix(".json")
    if not (output.exists() and summary.exists()):
        seconds = tool(name, *words, output, "--json", summary, processes=processes)
        summary.write_text(json.dumps(json.loads(summary.read_text()) | {"user_seconds": seconds}))
    return json.loads(summary.read_text())


def brick(size, packing, case=None):
    plain = options.folder / f"brick-{size}-{packing}.h5"
    if not plain.exists():
        tool("packgen", plain, "--particles", size, "--density", 0.64, "--random-seed", packing)
    if case is None:
        return plain
    path = options.folder / f"{case}-{size}-{packing}.h5"
    if not path.exists():
        shutil.copy(plain, path)
        samples.label(path, case)
    return path


def scene(name, phases, scheme, strain=STRAIN, accuracy=""):
    path = options.folder / f"{name}.toml"
    path.write_text(f"{phases}[load]\nsteps = [ {{ strain = {-strain}, rate = {RATE:g} }} ]\n"
                    f"[accuracy]\nframes = 3\n{scheme}{accuracy}\n")
    return path


QUASI_STATIC = 'scheme = "quasi_static"\n'


def run(name, sample, toml, processes=1):
    """Summary of a load, with the curves `strain` (positive) and `stress` (true, MPa) and the file."""
    result = options.folder / f"{name}.h5"
    summary = timed("solve", result, sample, toml, "--checkpoint-every", 0, processes=processes)
    with h5py.File(result) as file:
        strain, stress = (np.abs(file[f"observables/{key}/value"][:]) for key in ("strain", "stress_true"))
        # An inclusion's curve is as noisy as that of one phase: a mean over 0.02 of strain.
        return summary | {"strain": strain, "stress": stress / 1e6, "file": result,
                          "end": float(stress[strain > strain[-1] - 0.02].mean() / 1e6)}


def relaxed(name, sample, toml, processes=1):
    path = options.folder / f"{name}-relaxed.h5"
    return path, timed("relax", path, sample, toml, processes=processes)


def quasi_static(size, packing, exponent, case=None, processes=1, accuracy="", strain=STRAIN):
    """Summaries of relaxation and load of one phase with that M, or of a case of two."""
    what = case or f"M{exponent:g}"
    phases = phase("a", 1, PHASES["A"]) + phase("b", 2, PHASES["B"]) if case else phase("a", 1, (K, exponent))
    rest, rest_cost = relaxed(f"{what}-{size}-{packing}", brick(size, packing, case),
                              scene(f"{what}-relax", phases, QUASI_STATIC), processes)
    words = "".join(c for c in accuracy if c.isalnum() or c in ".-_")
    name = f"{what}-{size}-{packing}-{processes}{'-' + words if words else ''}{f'-{strain:g}' if strain != STRAIN else ''}"
    return rest, rest_cost, run(name, rest, scene(name, phases, QUASI_STATIC, strain, accuracy), processes)


def pm(values, form):
    return f"{np.mean(values):{form}}" + (f" ± {np.std(values, ddof=1):{form}}" if len(values) > 1 else "")


def table(title, *columns):
    lines.extend(["", title, "", "| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)])


def row(*cells):
    lines.append("| " + " | ".join(cells) + " |")
    print(lines[-1], flush=True)


def count():
    note = f", {options.accuracy}" if options.accuracy else ""
    table(f"Evaluations to strain {options.strain:g}, {options.packings} packing(s){note}", "case", "particles",
          "evaluations", "steps", "of the hardest step", "ns an evaluation and particle (user CPU)",
          "of the relaxation", "bytes a particle", "stress over K rate^M, or MPa", "S_f at 0.3")
    for size in options.particles:
        for exponent in [*options.exponents, *([] if options.no_inclusion else [None])]:
            case = "inclusion" if exponent is None else None
            all_runs = [quasi_static(size, p, exponent, case, options.np, options.accuracy, options.strain)
                        for p in range(1, options.packings + 1)]
            loads = [load for _, _, load in all_runs]
            counts = [load["evaluations"] for load in loads]
            hardest = []
            for load in loads:
                with h5py.File(load["file"]) as file:
                    hardest.append(file["observables/evaluations/value"][:].max())
            stress = [load["end"] / (1 if case else K * RATE**exponent) for load in loads]
            form = [samples.shape(load["file"], STRAIN) for load in loads] if case else None
            row(case or f"M = {exponent:g}", str(size), pm(counts, ".0f"), f"{len(loads[0]['strain']) - 1}", pm(hardest, ".0f"),
                pm([1e9 * load["user_seconds"] / load["evaluations"] / size for load in loads], ".0f"),
                pm([rest["evaluations"] for _, rest, _ in all_runs], ".0f"),
                f"{max(load['peak_bytes'] for load in loads) / size:.0f}", pm(stress, ".1f" if case else ".3f"),
                pm(form, ".3f") if case else "-")
            if case and options.fem and options.strain == STRAIN:
                elements = samples.reference(options.fem, "inclusion_stress_strain_rate1e-3.csv", 0.29)
                factor = samples.reference(options.fem, "inclusion_shape_factor_rate1e-3.csv", STRAIN)
                row("finite elements", "", "", "", "", "", "", "", f"{elements * np.exp(-0.29):.1f}", f"{factor:.3f}")


def cost():
    size = max(options.particles)
    exponent = 0.3
    table(f"User CPU to strain {STRAIN:g}, {size} particles, M = {exponent:g}, side by side", "law and scheme", "steps",
          "user CPU [s]", "bytes a particle", "quasi-static takes less by")
    rest, _, flow = quasi_static(size, 1, exponent)
    one = phase("a", 1, (K, exponent))
    share = STRAIN if size <= WHOLE_EXPLICIT_RUN else EXPLICIT_SHARE
    slow = run(f"explicit-{size}-{share:g}", rest, scene(f"explicit-{size}", one, 'scheme = "explicit"\n', share))
    # Rates are the same to the end, and so is the time step.
    steps = STRAIN / (RATE * slow["time_step"])
    seconds = slow["user_seconds"] * STRAIN / share
    bilin = phase("a", 1, (K, exponent), "bilin")
    step = f"strain_per_step = {BILIN_STRAIN_STEP:g}\n"
    bilin_rest, _ = relaxed(f"bilin-{size}", brick(size, 1), scene(f"bilin-{size}-relax", bilin, step))
    other = run(f"bilin-{size}", bilin_rest, scene(f"bilin-{size}", bilin, step))
    of_explicit = "" if share == STRAIN else f" (run to strain {share:g}, scaled by the steps)"
    for name, count_of_steps, spent, memory in (
            ("NORTON, quasi-static", len(flow["strain"]) - 1, flow["user_seconds"], flow["peak_bytes"]),
            ("NORTON, explicit" + of_explicit, steps, seconds, slow["peak_bytes"]),
            (f"BILIN, {BILIN_STRAIN_STEP:g} of strain a step", STRAIN / BILIN_STRAIN_STEP, other["user_seconds"],
             other["peak_bytes"])):
        row(name, f"{count_of_steps:.0f}", f"{spent:.1f}", f"{memory / size:.0f}", f"{spent / flow['user_seconds']:.1f}")


def agree():
    size = min(options.particles)
    table(f"True stress over K rate^M of both schemes, {size} particles, the same relaxed samples", "M", "strain",
          "quasi-static", "explicit", "difference")
    for exponent in (0.1, 0.3, 1.0):
        pairs = []
        for packing in range(1, options.packings + 1):
            rest, _, flow = quasi_static(size, packing, exponent)
            slow = run(f"explicit-M{exponent:g}-{size}-{packing}", rest,
                       scene(f"explicit-M{exponent:g}", phase("a", 1, (K, exponent)), 'scheme = "explicit"\n',
                             accuracy=f"averaging_strain = {SHORT_WINDOW:g}\n"))
            pairs.append((flow, slow))
        for low, high in ((0.08, 0.12), (0.18, 0.22), (0.26, 0.3)):
            means = np.array([[one["stress"][(one["strain"] >= low) & (one["strain"] <= high)].mean() for one in pair]
                              for pair in pairs]) / (K * RATE**exponent)
            row(f"{exponent:g}", f"{low:g} to {high:g}", pm(means[:, 0], ".4f"), pm(means[:, 1], ".4f"),
                pm(100 * (means[:, 0] / means[:, 1] - 1), "+.2f") + " %")


def processes():
    size = min(options.particles)
    table(f"Several processes, {size} particles, M = 0.3, the same relaxed sample", "processes", "evaluations",
          "stress at 0.3 over that of one", "largest difference of stress from 0.02 on", "user CPU [s]")
    rest, _, one = quasi_static(size, 1, 0.3)
    for number in (1, 2, 4):
        name = f"processes-{size}-{number}"
        flow = run(name, rest, scene(name, phase("a", 1, (K, 0.3)), QUASI_STATIC), number)
        ratio = flow["stress"][1:] / one["stress"][1:]
        late = one["strain"][1:] >= 0.02
        row(str(number), str(flow["evaluations"]), f"{ratio[-1]:.5f}", f"{100 * np.abs(ratio[late] - 1).max():.3f} %",
            f"{flow['user_seconds']:.1f}")


for part in options.parts:
    {"count": count, "cost": cost, "agree": agree, "processes": processes}[part]()
text = "\n".join(lines).lstrip()
print("\n" + text)
(options.folder / "tables.md").write_text(text + "\n")
