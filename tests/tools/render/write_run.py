#!/usr/bin/python3
"""Writes an H5MD run without tomodem: a cube of touching spheres on a lattice, a ball of label 2 in its middle (one
object for each half), two frames, the second compressed along z at constant volume.

usage: write_run.py OUT.h5 SPHERES_PER_EDGE           the ball is another phase
       write_run.py OUT.h5 SPHERES_PER_EDGE --pore    the ball is not there
       write_run.py OUT.h5 SPHERES_PER_EDGE --pore --off   its middle is at a quarter of the sample along y, and it is smaller
       write_run.py OUT.h5 SPHERES_PER_EDGE --fields  with a property "height" (0 to 1 from below to above), and in the second
                                                      frame stress (zz 200 MPa, in the ball -200 MPa) and outward (from the
                                                      middle line along x, of length 1 mm)
"""
import sys

import h5py
import numpy as np

path, edge = sys.argv[1], int(sys.argv[2])
radius = 0.5
index = np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
position = (index + 0.5) * 2 * radius
centre = np.full(3, edge * radius)
inside = np.linalg.norm(position - centre, axis=1) < 0.35 * edge
if "--off" in sys.argv:
    inside = np.linalg.norm(position - centre * (1, 0.5, 1), axis=1) < 0.2 * edge
if "--pore" in sys.argv:
    index, position, inside = index[~inside], position[~inside], np.zeros(np.count_nonzero(~inside), bool)
strain = -0.3
stretch = np.exp([-strain / 2, -strain / 2, strain])

with h5py.File(path, "w") as file:
    file.create_group("h5md").attrs["version"] = np.array([1, 1], dtype="i4")
    particles = file.create_group("particles/all")
    particles.attrs["seed_radius"] = radius
    particles["species"] = np.where(inside, 2, 1).astype("i4")
    particles["object"] = np.where(inside, 1 + (position[:, 2] > centre[2]), 0).astype("i4")
    particles["id"] = np.arange(1, len(position) + 1)
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = [b"none"] * 3
    box["edges"] = np.full(3, 2.0 * edge * radius)
    frames = particles.create_group("position")
    frames["value"] = np.stack([position, centre + (position - centre) * stretch])
    frames["step"] = [0, 100]
    frames["time"] = [0.0, 300.0]
    curve = file.create_group("observables/strain")
    curve["value"], curve["step"], curve["time"] = [0.0, strain], [0, 100], [0.0, 300.0]
    curve.attrs["unit"] = "1"
    if "--fields" in sys.argv:
        particles.create_group("property")["height"] = index[:, 2] / (edge - 1)
        stress = np.full((2, len(position), 6), np.nan)
        stress[1] = 0
        stress[1, :, 2] = np.where(inside, -2e8, 2e8)
        outward = np.zeros((2, len(position), 3))
        outward[1, :, 0] = np.sign(position[:, 0] - centre[0])
        for name, values, unit in (("stress", stress, "Pa"), ("outward", outward, "mm")):
            field = particles.create_group(name)
            field["value"] = values
            field["value"].attrs["unit"] = unit
            field["step"], field["time"] = frames["step"], frames["time"]
