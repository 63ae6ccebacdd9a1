#!/usr/bin/python3
"""What the limits of a free relaxation change: periods, shape and flow stress of samples relaxed to each of them.

For every law a packing is relaxed to a list of energy ratios (the force balance follows: its limit is 100 times as
high), and pressed to a strain of -0.35. Prints, for each limit, the periods that it took, the ratios reached, the root
mean square distance of the centres from where the tightest limit leaves them (after the best translation), the radius of
gyration over that of the tightest limit, and the mean stress from strain 0.25 to 0.35 over that of the tightest limit.

usage: rest.py BIN [--particles N ...] [--packings P] [--laws LAW ...] [--no-pressing]
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

LIMITS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
LAWS = {  # phase, density of the packing
    "bilin-A": ('law = "bilin"\nnorton = { K = 95.9, M = 2.45e-3 }\n', 0.70),
    "bilin-B": ('law = "bilin"\nnorton = { K = 5020, M = 0.49 }\n', 0.70),
    "trilin": ('law = "trilin"\nnorton = { K = 49.1, M = 0.0714 }\n', 0.74),
    "norton": ('law = "norton"\nnorton = { K = 5020, M = 0.49 }\n', 0.64),
}

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--particles", type=int, nargs="+", default=[2000, 20000])
parser.add_argument("--packings", type=int, default=3)
parser.add_argument("--laws", nargs="+", default=list(LAWS), choices=list(LAWS))
parser.add_argument("--no-pressing", action="store_true")
options = parser.parse_args()
tools = options.bin.resolve()


def call(tool, *arguments):
    subprocess.run([tools / tool, *map(str, arguments), "--quiet"], check=True, stderr=subprocess.DEVNULL)


def centres():
    with h5py.File("relaxed.h5") as file:
        position = file["particles/all/position/value"][0]
    return position - position.mean(axis=0)


def flow_stress():
    call("solve", "relaxed.h5", "scene.toml", "run.h5")
    with h5py.File("run.h5") as run:
        strain, stress = (run[f"observables/{name}/value"][:] for name in ("strain", "stress_true"))
    chosen = (strain <= -0.25) & (strain >= -0.35)
    return -stress[chosen].mean() / 1e6


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for count in options.particles:
        for law in options.laws:
            phase, density = LAWS[law]
            pathlib.Path("scene.toml").write_text(
                f"[phase.a]\nlabel = 1\n{phase}[load]\nsteps = [ {{ strain = -0.35, rate = 1e-3 }} ]\n"
                "[accuracy]\nframes = 1\n" + ("" if law == "norton" else "strain_per_step = 2.5e-5\n"))
            rows = {limit: [] for limit in LIMITS}
            for packing in range(1, options.packings + 1):
                call("packgen", "brick.h5", "--particles", count, "--density", density, "--random-seed", packing)
                last = None
                for limit in reversed(LIMITS):
                    if law == "norton" and limit < 1e-4:
                        continue
                    call("relax", "brick.h5", "scene.toml", "relaxed.h5", "--energy-ratio", limit, "--force-balance",
                         min(1, 100 * limit if law != "norton" else 10 * limit), "--json", "relaxed.json")
                    summary = json.loads(pathlib.Path("relaxed.json").read_text())
                    found = centres()
                    stress = np.nan if options.no_pressing else flow_stress()
                    gyration = np.sqrt((found**2).sum(axis=1).mean())
                    if last is None:
                        last = found, gyration, stress
                    apart = np.sqrt(((found - last[0])**2).sum(axis=1).mean()) / 0.5
                    rows[limit].append([summary[key] for key in ("periods", "energy_ratio", "force_balance")]
                                       + [apart, gyration / last[1] - 1, stress, stress / last[2] - 1])
            print(f"{law}, {count} particles, {options.packings} packings")
            for limit, values in rows.items():
                if values:
                    mean, spread = np.mean(values, axis=0), np.abs(np.array(values)[:, 6]).max()
                    print(f"  {limit:.0e}: {mean[0]:6.1f} periods, ratio {mean[1]:.1e}, balance {mean[2]:.1e}, "
                          f"{mean[3]:.4f} r_s from rest, size {mean[4]:+.5f}, stress {mean[5]:.1f} MPa, "
                          f"{mean[6]:+.2%} (at most {spread:.2%})", flush=True)
