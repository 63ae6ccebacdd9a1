#!/usr/bin/python3
"""Takes the particles of a spherical pore out of the middle of a brick.

usage: drill_pore.py BRICK.h5 SAMPLE.h5 RELATIVE_RADIUS      (pore radius over half the edge of the brick)
"""
import sys

import h5py
import numpy as np

brick, sample, relative = sys.argv[1], sys.argv[2], float(sys.argv[3])
with h5py.File(brick) as source, h5py.File(sample, "w") as target:
    for key in ("h5md", "parameters"):
        source.copy(key, target)
    everything = target.create_group("particles/all")
    everything.attrs.update(source["particles/all"].attrs)
    for key in ("box", "position", "species", "id"):
        source.copy(f"particles/all/{key}", everything)
    position = everything["position/value"][0]
    middle = (position.min(axis=0) + position.max(axis=0)) / 2
    half_edge = (position.max(axis=0) - position.min(axis=0)).mean() / 2
    kept = np.linalg.norm(position - middle, axis=1) > relative * half_edge
    del everything["position/value"]
    everything["position/value"] = position[None, kept]
    for key in ("species", "id"):
        data = everything[key][:][kept]
        del everything[key]
        everything[key] = data
