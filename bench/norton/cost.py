#!/usr/bin/python3
"""CPU time of law NORTON against BILIN: of a particle and step, and of a whole compression to strain 0.3.

The same packing, pressed with planes, curves and frames; times are differences of a long and a short run, least of the
runs, which alternate. The whole compression is that time by the steps that each law takes: BILIN at cost factor 50, 2.5e-5
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
BILIN_STRAIN_STEP = 2.5e-5

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--particles", type=int, default=50000)
parser.add_argument("--runs", type=int, default=3)
options = parser.parse_args()
tools = options.bin.resolve()


def run(law, strain):
    """CPU seconds and steps."""
    time_step = f"time_step = {5e-3}\n" if law == "bilin" else ""
    pathlib.Path("scene.toml").write_text(f"[phase.a]\nlabel = 1\n{PHASE[law]}[load]\nsteps = [ {{ strain = {-strain}, "
                                          f"rate = {RATE} }} ]\n[accuracy]\n{time_step}frames = 2\n"
                                          f"averaging_strain = {0.5 * strain}\n")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([tools / "solve", f"{law}.h5", "scene.toml", "run.h5", "--quiet", "--json", "run.json"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads(pathlib.Path("run.json").read_text())
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, summary


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([tools / "packgen", "brick.h5", "--particles", str(options.particles), "--density", "0.64", "--quiet"],
                   check=True)
    found = {}
    for law in PHASE:
        os.link("brick.h5", f"{law}.h5")
        run(law, 1e-4)
        subprocess.run([tools / "relax", "brick.h5", "scene.toml", f"{law}-relaxed.h5", "--quiet", "--periods",
                        "20" if law == "bilin" else "2"], check=True)
        os.replace(f"{law}-relaxed.h5", f"{law}.h5")
    for _ in range(options.runs):
        for law, strains in (("bilin", (5e-4, 2.5e-3)), ("norton", (5e-4, 4e-3))):
            (short, first), (long, second) = (run(law, strain) for strain in strains)
            found.setdefault(law, []).append((long - short) / (second["steps"] - first["steps"]) / options.particles)
            memory = second["peak_bytes"] / options.particles
            found[f"{law} steps"] = 0.3 / BILIN_STRAIN_STEP if law == "bilin" else 0.3 / (RATE * second["time_step"])
            found[f"{law} memory"] = memory
    cost = {law: min(found[law]) for law in PHASE}
    for law in PHASE:
        print(f"{law:7} {1e9 * cost[law]:6.1f} ns a particle and step, {found[f'{law} steps']:6.0f} steps to strain 0.3, "
              f"{cost[law] * found[f'{law} steps'] * options.particles:6.0f} s for {options.particles} particles, "
              f"{found[f'{law} memory']:.0f} bytes a particle")
    print(f"norton / bilin: {cost['norton'] / cost['bilin']:.1f} a step, "
          f"{cost['norton'] * found['norton steps'] / cost['bilin'] / found['bilin steps']:.2f} for the whole compression")
