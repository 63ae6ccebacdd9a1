#!/usr/bin/python3
"""Stress overshoot of a tall sample with and without flow initiation, and which part of it does the work.

Bricks of 500 particles stacked to an aspect ratio of 8, BILIN with t0 = 2.53 s at 1e-2 /s: the planes are fast against
the time that a disturbance takes through the sample. The overshoot is the highest stress (mean over 0.002 of strain)
below strain 0.1 over the mean stress between 0.2 and 0.3.

usage: initiation.py BIN [PACKINGS]
"""
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

import h5py
import numpy as np

BIN = pathlib.Path(sys.argv[1])
PACKINGS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
LAYERS = 8
SCENE = """[phase.b]
label = 1
law = "bilin"
repulsive_stiffness = 2.65e9
natural_period = 2.53
[load]
{initiation}
steps = [ {{ strain = -0.3, rate = 1e-2 }} ]
[accuracy]
time_step = 5e-3
averaging_strain = 0.002
frames = 1
"""
CASES = {
    "none": "",
    "ramp alone": "initiation = { strain = 0.02, affine = false }",
    "long ramp alone": "initiation = { strain = 0.1, affine = false }",
    "affine at once": "initiation = { strain = 1e-4 }",
    "ramp + affine": "initiation = { strain = 0.02 }",
    "ramp + noise": "initiation = { strain = 0.02, affine = false, noise = 0.1 }",
    "ramp + affine + noise": "initiation = { strain = 0.02, noise = 0.1 }",
}


def call(*words):
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL)


def stack(brick, tall):
    """The periodic brick, repeated upwards."""
    shutil.copy(brick, tall)
    with h5py.File(tall, "r+") as file:
        group = file["particles/all"]
        position, edges = group["position/value"][0], group["box/edges"][:]
        count = len(position)
        columns = {
            "position/value": np.concatenate([position + [0, 0, k * edges[2]] for k in range(LAYERS)])[None],
            "species": np.tile(group["species"][:], LAYERS),
            "id": np.arange(1, count * LAYERS + 1),
        }
        for name, values in columns.items():
            kind, attributes = group[name].dtype, dict(group[name].attrs)
            del group[name]
            group.create_dataset(name, data=values.astype(kind)).attrs.update(attributes)
        edges[2] *= LAYERS
        group["box/edges"][...] = edges


def measure(run):
    with h5py.File(run) as file:
        strain = -file["observables/strain/value"][:]
        stress = -file["observables/stress_true/value"][:] / 1e6
    plateau = stress[strain > 0.2].mean()
    return stress[strain < 0.1].max() / plateau - 1, plateau


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    results = {name: [] for name in CASES}
    pathlib.Path("relax.toml").write_text(SCENE.format(initiation=""))
    for seed in range(1, PACKINGS + 1):
        call(BIN / "packgen", "brick.h5", "--particles", 500, "--density", 0.70, "--random-seed", seed, "--quiet")
        stack("brick.h5", "tall.h5")
        call(BIN / "relax", "tall.h5", "relax.toml", "relaxed.h5", "--quiet")
        for name, initiation in CASES.items():
            pathlib.Path("scene.toml").write_text(SCENE.format(initiation=initiation))
            call(BIN / "solve", "relaxed.h5", "scene.toml", "run.h5", "--quiet")
            results[name].append(measure("run.h5"))
    for name, pairs in results.items():
        overshoot, plateau = zip(*pairs)
        print(f"{name:>22}: overshoot {statistics.mean(overshoot):+.2f} ({min(overshoot):+.2f} to {max(overshoot):+.2f}), "
              f"stress from 0.2 to 0.3 {statistics.mean(plateau):.0f} MPa ({min(plateau):.0f} to {max(plateau):.0f})")
