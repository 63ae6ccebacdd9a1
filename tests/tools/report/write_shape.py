#!/usr/bin/python3
"""Writes a small H5MD run or sample of one of the shapes that runs have, without tomodem: a jittered lattice, pressed to strain -0.2.

usage: write_shape.py OUT.h5 [--edge N] [--frames N] [--objects N | --grains] [--pore closed|open] [--curves all|strain|none] [--unfinished]

  --edge       spheres along an edge (default 9)
  --objects    so many balls of label 2, one after the other along z
  --grains     every block of 3 x 3 x 3 spheres is an object
  --pore       a ball is missing in the middle, or at the upper face
  --curves     those of solve, that of strain alone, or none: a sample
  --unfinished two more frames and half of the points are still to come, as in NAME.h5.partial
"""
import argparse

import h5py
import numpy as np

parser = argparse.ArgumentParser()
parser.add_argument("out")
parser.add_argument("--edge", type=int, default=9)
parser.add_argument("--frames", type=int, default=2)
parser.add_argument("--objects", type=int, default=0)
parser.add_argument("--grains", action="store_true")
parser.add_argument("--pore", choices=("closed", "open"))
parser.add_argument("--curves", choices=("all", "strain", "none"), default="all")
parser.add_argument("--unfinished", action="store_true")
words = parser.parse_args()

edge, radius = words.edge, 0.5
index = np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
position = (index + 0.5) * 0.95 + np.random.default_rng(1).uniform(-0.08, 0.08, (len(index), 3))
middle = np.full(3, edge * 0.95 / 2)
number = np.zeros(len(position), "i4")
for k in range(words.objects):
    centre = middle * (1, 1, (2 * k + 1) / words.objects)
    number[np.linalg.norm(position - centre, axis=1) < 2] = k + 1
if words.grains:
    block = index // 3
    number = (1 + block @ [(edge // 3) ** 2, edge // 3, 1]).astype("i4")
if words.pore:
    centre = middle if words.pore == "closed" else middle * (1, 1, 2)
    kept = np.linalg.norm(position - centre, axis=1) > 2.4
    position, number = position[kept], number[kept]

times = np.linspace(0, 200, words.frames) if words.frames > 1 else np.zeros(1)
strains = -1e-3 * times
value = np.stack([middle + (position - middle) * np.exp([-strain / 2, -strain / 2, strain]) for strain in strains])
step = 100 * np.arange(words.frames)
if words.unfinished:
    value = np.concatenate([value, np.zeros((2, *value.shape[1:]))])
    step, times = np.append(step, [-1, -1]), np.append(times, [0, 0])

with h5py.File(words.out, "w") as file:
    file.create_group("h5md").attrs["version"] = np.array([1, 1], dtype="i4")
    particles = file.create_group("particles/all")
    particles.attrs["seed_radius"] = radius
    particles["species"] = np.where(number > 0, 2, 1).astype("i4")
    if words.objects or words.grains:
        particles["object"] = number
    particles["id"] = np.arange(1, len(position) + 1)
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = [b"none"] * 3
    box["edges"] = np.full(3, 0.95 * edge)
    frames = particles.create_group("position")
    frames["value"], frames["step"], frames["time"] = value, step, times
    if words.curves != "none":
        time = np.linspace(0, 200, 101)
        strain = -1e-3 * time
        stress = -1e8 * (1 - np.exp(strain / 0.05))
        section = (0.95 * edge) ** 2
        curves = {"strain": ("", strain)}
        if words.curves == "all":
            curves |= {"stress_true": ("Pa", stress), "stress_engineering": ("Pa", stress * np.exp(-strain)),
                       "force_top": ("uN", 1.005 * -stress * section), "force_bottom": ("uN", 0.995 * stress * section),
                       "equilibrium_error": ("", np.full(101, 0.01)), "section": ("mm^2", section * np.exp(-strain))}
        for name, (unit, values) in curves.items():
            curve = file.create_group(f"observables/{name}")
            points = np.arange(101)
            if words.unfinished:
                points[51:], values[51:], time[51:] = -1, np.nan, 0
            curve["value"], curve["step"], curve["time"] = values, points, time
            curve.attrs["unit"] = unit
