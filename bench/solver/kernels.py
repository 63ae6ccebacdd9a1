#!/usr/bin/python3
"""CPU time per particle and step of `solve`, vector kernel against scalar loop, interleaved on the same sample.

A whole run is timed: set-up, neighbour lists, planes, curves and frames included.

usage: kernels.py BIN [PARTICLES [RUNS]]
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

BIN = pathlib.Path(sys.argv[1])
PARTICLES = int(float(sys.argv[2])) if len(sys.argv) > 2 else 50_000
RUNS = int(sys.argv[3]) if len(sys.argv) > 3 else 3
SCENE = """[phase.b]
label = 1
law = "bilin"
repulsive_stiffness = 2.65e9
natural_period = 2.53
[load]
steps = [ { strain = -0.0025, rate = 1e-3 } ]
[accuracy]
time_step = 5e-3
frames = 1
"""


def call(*words, **environment):
    subprocess.run([str(word) for word in words], check=True, env=os.environ | environment)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    pathlib.Path("scene.toml").write_text(SCENE)
    call(BIN / "packgen", "brick.h5", "--particles", PARTICLES, "--density", 0.70, "--quiet")
    call(BIN / "relax", "brick.h5", "scene.toml", "relaxed.h5", "--quiet")
    seconds = {"scalar": [], "vector": []}
    for _ in range(RUNS):
        for kernel, times in seconds.items():
            call(BIN / "solve", "relaxed.h5", "scene.toml", "run.h5", "--quiet", "--json", "run.json",
                 TOMODEM_KERNEL=kernel)
            summary = json.loads(pathlib.Path("run.json").read_text())
            times.append(1e9 * summary["seconds_per_particle_step"])
            per_particle = summary["peak_bytes"] / PARTICLES
    for kernel, times in seconds.items():
        print(f"{kernel}: {min(times):.1f} ns per particle and step, median {statistics.median(times):.1f} of {RUNS}")
    ratios = [a / b for a, b in zip(seconds["scalar"], seconds["vector"])]
    print(f"scalar / vector: {min(ratios):.2f} to {max(ratios):.2f}, median {statistics.median(ratios):.2f}")
    print(f"peak memory: {per_particle:.0f} bytes a particle at {PARTICLES} particles")
