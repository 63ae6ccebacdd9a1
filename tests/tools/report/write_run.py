#!/usr/bin/python3
"""Writes an H5MD run without tomodem: a jittered lattice in which everything is known.

Two balls of label 2 are objects; a pore in the middle shrinks from frame to frame, each sphere around it moving as an
incompressible medium does, and is closed in the last frame; meanwhile all is compressed to strain -0.3 at constant volume.

usage: write_run.py OUT.h5           the run, its curves as a solver writes them
       write_run.py OUT.h5 --sample  the first frame alone, of one phase, without objects, curves and provenance
"""
import sys

import h5py
import numpy as np

path, sample = sys.argv[1], "--sample" in sys.argv
edge, radius, frames = 15, 0.5, 5
index = np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
position = (index + 0.5) * 0.95 + np.random.default_rng(1).uniform(-0.08, 0.08, (len(index), 3))
centre = np.full(3, edge * 0.95 / 2)
pore = 2.6
away = np.linalg.norm(position - centre, axis=1)
position, away = position[away > pore], away[away > pore]
balls = [centre + (-4, 0, 2), centre + (4, 1, -2)]
number = np.zeros(len(position), "i4")
for k, ball in enumerate(balls):
    number[np.linalg.norm(position - ball, axis=1) < 2.2] = k + 1

times = np.linspace(0, 300, frames)
strains = -1e-3 * times
moved = []
for k, strain in enumerate(strains):
    now = pore * (1 - k / (frames - 1))
    shrunk = np.cbrt(away**3 - pore**3 + now**3)
    moved.append(centre + (position - centre) * (shrunk / away)[:, None] * np.exp([-strain / 2, -strain / 2, strain]))

with h5py.File(path, "w") as file:
    file.create_group("h5md").attrs["version"] = np.array([1, 1], dtype="i4")
    particles = file.create_group("particles/all")
    particles.attrs["seed_radius"] = radius
    particles["species"] = np.where((number > 0) & (not sample), 2, 1).astype("i4")
    if not sample:
        particles["object"] = number
    particles["id"] = np.arange(1, len(position) + 1)
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = [b"none"] * 3
    box["edges"] = np.full(3, 0.95 * edge)
    value = particles.create_group("position")
    shown = 1 if sample else frames
    value["value"] = np.stack(moved[:shown])
    value["step"] = 100 * np.arange(shown)
    value["time"] = times[:shown]
    if not sample:
        time = np.linspace(0, 300, 301)
        strain = -1e-3 * time
        stress = -1e8 * (1 - np.exp(strain / 0.05))
        section = (0.95 * edge) ** 2
        curves = {
            "strain": ("", strain), "stress_true": ("Pa", stress), "stress_engineering": ("Pa", stress * np.exp(-strain)),
            "force_top": ("uN", 1.005 * -stress * section), "force_bottom": ("uN", 0.995 * stress * section),
            "equilibrium_error": ("", np.full(301, 0.01)), "section": ("mm^2", section * np.exp(-strain)),
        }
        for name, (unit, values) in curves.items():
            curve = file.create_group(f"observables/{name}")
            curve["value"], curve["step"], curve["time"] = values, np.arange(301), time
            curve.attrs["unit"] = unit
