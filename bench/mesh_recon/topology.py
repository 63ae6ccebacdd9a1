#!/usr/bin/python3
"""topology.py BIN BRICK.h5: events of `topology` on scripted frames of a random packing (diameter 1).

Two spheres, ten diameters apart, are taken out of the brick, ever larger ones and then ever smaller ones; then one half of the
brick moves away from the other. Prints the frames and the events.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

programs, brick = Path(sys.argv[1]), sys.argv[2]
with h5py.File(brick) as file:
    centres = file["/particles/all/position/value"][0]
    radius = file["/particles/all"].attrs["seed_radius"]
middle = (centres.min(axis=0) + centres.max(axis=0)) / 2
away = middle + np.array([1000, 0, 0]) + 10 * (centres - middle)  # scattered: in no part

frames, names = [], []
for size in [0, 2, 3, 3.5, 4, 4.5, 5, 4.5, 4, 3.5, 3, 2, 0]:
    points = centres.copy()
    for side in (-5, 5):
        hole = np.linalg.norm(centres - middle - [side, 0, 0], axis=1) < size
        points[hole] = away[hole]
    frames.append(points)
    names.append(f"two holes of radius {size}")
for gap in np.arange(0.1, 1.6, 0.1):
    frames.append(centres + np.where(centres[:, 2:] > middle[2], [0, 0, gap], 0))
    names.append(f"cut in the middle, moved apart by {gap:.1f}")

with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    with h5py.File(brick) as old, h5py.File(folder / "run.h5", "w") as new:
        for name in old:
            old.copy(name, new)
        position = new["/particles/all/position"]
        for name, values in (("value", np.array(frames)), ("step", np.arange(len(frames))),
                             ("time", np.arange(len(frames), dtype=float))):
            del position[name]
            position[name] = values
    subprocess.run([programs / "topology", folder / "run.h5", folder / "frames.csv", "--events", folder / "events.csv",
                    "--quiet"], check=True)
    events = [line.split(",") for line in (folder / "events.csv").read_text().splitlines()[1:]]
    for index, line in enumerate((folder / "frames.csv").read_text().splitlines()[1:]):
        numbers = line.split(",")
        print(f"{names[index]:40} b0 {numbers[3]:>3}  b1 {numbers[4]:>3}  b2 {numbers[5]:>3}",
              *(f"{e[0]} at ({float(e[5]) - middle[0]:.1f}, {float(e[6]) - middle[1]:.1f}, {float(e[7]) - middle[2]:.1f})"
                for e in events if int(e[1]) == index), sep="  ")
