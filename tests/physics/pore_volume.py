#!/usr/bin/python3
"""Volume of the pore of runs at three moments: at the start, at the largest compression, at the end.

usage: pore_volume.py RUN.h5 ...

The pore is what balls of radius 0.9 mm fill that hold no particle's centre, in the inner 60 % of the sample along every
axis (a wrap by a large probe would count the neck too). Prints a JSON object: name -> the three volumes [mm^3].
"""
import json
import sys

import h5py
import numpy as np

PROBE, VOXEL = 0.9, 0.2  # mm


def ball(radius):
    reach = np.arange(-int(radius / VOXEL), int(radius / VOXEL) + 1)
    offsets = np.stack(np.meshgrid(reach, reach, reach, indexing="ij"), axis=-1).reshape(-1, 3)
    return offsets[(offsets**2).sum(axis=1) * VOXEL**2 <= radius**2]


def stamp(places, shape):
    """Voxels within the probe's radius of the places."""
    covered = np.zeros(shape, bool)
    for offset in ball(PROBE):
        inside = places + offset
        inside = inside[((inside >= 0) & (inside < shape)).all(axis=1)]
        covered[tuple(inside.T)] = True
    return covered


def pore(position):
    low, high = np.percentile(position, 0.5, axis=0), np.percentile(position, 99.5, axis=0)
    low, high = low + 0.2 * (high - low), high - 0.2 * (high - low)
    shape = np.ceil((high - low) / VOXEL).astype(int)
    centres = np.floor((position - low) / VOXEL).astype(int)
    free = np.argwhere(~stamp(centres, shape))
    return float(stamp(free, shape).sum() * VOXEL**3)


volumes = {}
for name in sys.argv[1:]:
    with h5py.File(name) as run:
        position = run["particles/all/position"]
        curve = run["observables/strain"]
        strain = np.interp(position["time"][:], curve["time"][:], curve["value"][:])
        volumes[name.removesuffix(".h5")] = [
            round(pore(position["value"][frame]), 2) for frame in (0, int(strain.argmin()), len(strain) - 1)]
print(json.dumps(volumes))
