#!/usr/bin/python3
"""CPU time of law NORTON against BILIN: of a particle and step, and of a whole compression to strain 0.3.

The loop alone, in free relaxations of the same packing; times are differences of a long and a short one, least of the
runs, which alternate. The whole compression is that time by the steps that each law takes: BILIN with 5e-6 and with 2.5e-5
of strain in a step, NORTON as it chooses itself.

usage: cost.py BIN [--particles N] [--runs R]
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import tempfile

RATE = 1e-3
PHASE = {
    "bilin": 'law = "bilin"\nrepulsive_stiffness = 2.65e9\nnatural_period = 2.53\n',
    "norton": 'law = "norton"\nnorton = { K = 5020, M = 0.49 }\n',
}
BILIN_STRAIN_STEPS = (5e-6, 2.5e-5)

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--particles", type=int, default=50000)
parser.add_argument("--runs", type=int, default=3)
options = parser.parse_args()
tools = options.bin.resolve()


def run(law, periods):
    """CPU seconds and the summary of a relaxation."""
    pathlib.Path("scene.toml").write_text(f"[phase.a]\nlabel = 1\n{PHASE[law]}[load]\nsteps = [ {{ strain = -0.3, "
                                          f"rate = {RATE} }} ]\n[accuracy]\nscheme = \"explicit\"\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([tools / "relax", "brick.h5", "scene.toml", "free.h5", "--quiet", "--max-periods", str(periods),
                    "--energy-ratio", "1e-300", "--json", "run.json"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads(pathlib.Path("run.json").read_text())
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, summary


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([tools / "packgen", "brick.h5", "--particles", str(options.particles), "--density", "0.64", "--quiet"],
                   check=True)
    cost, steps, memory = {law: [] for law in PHASE}, {}, {}
    for _ in range(options.runs):
        for law, periods in (("bilin", (5, 25)), ("norton", (1, 3))):
            (short, first), (long, second) = (run(law, number) for number in periods)
            done = second["steps"] - first["steps"]
            cost[law].append((long - short) / done / options.particles)
            memory[law] = second["peak_bytes"] / options.particles
            # A relaxation of a NORTON sample takes the time of 0.003 of strain in a period.
            steps[law] = 0.3 / 0.003 * done / (periods[1] - periods[0])
    least = {law: min(values) for law, values in cost.items()}
    for law in PHASE:
        print(f"{law:7} {1e9 * least[law]:6.1f} ns a particle and step, {memory[law]:.0f} bytes a particle")
    print(f"norton / bilin: {least['norton'] / least['bilin']:.1f} a step")
    norton = least["norton"] * steps["norton"] * options.particles
    print(f"to strain 0.3: norton {steps['norton']:.0f} steps, {norton:.0f} s; "
          + ", ".join(f"bilin {0.3 / step:.0f} steps of {step:g}, {least['bilin'] * 0.3 / step * options.particles:.0f} s"
                      for step in BILIN_STRAIN_STEPS))
