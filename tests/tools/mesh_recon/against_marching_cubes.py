#!/usr/bin/python3
"""Each pore of `pores --each` beside its own voxels: volume and sphericity by marching cubes (scikit-image).

usage: against_marching_cubes.py image VOXELS OUT.h5         write an image of four ellipsoidal pores, 10 to 11 particles across
       against_marching_cubes.py compare IMAGE.h5 VOXEL_MM EACH.csv
"""
import csv
import sys

import h5py
import numpy as np
from scipy.ndimage import gaussian_filter
from skimage.measure import label, marching_cubes, mesh_surface_area

# Semi-axes over the radius of the ball of the same volume, and that radius over the seed radius.
SHAPES = [((1, 1, 1), 10), ((1.59, 0.79, 0.79), 11), ((1.26, 1.26, 0.63), 10), ((1.8, 1.0, 0.556), 11)]


def write_image(seed_voxels, path):
    random, pitch = np.random.default_rng(2), int(42 * seed_voxels)
    at = np.arange(2 * pitch) + 0.5
    z, y, x = at[:pitch, None, None], at[None, :, None], at[None, None, :]
    pores = np.zeros((pitch, 2 * pitch, 2 * pitch), bool)
    for k, (axes, radius) in enumerate(SHAPES):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        middle = pitch * (np.array([k & 1, k >> 1, 0]) + 0.5) + random.uniform(-1, 1, 3)
        distance = 0
        for direction, axis in zip(turn, axes):
            along = sum(component * (c - m) for component, c, m in zip(direction, (x, y, z), middle))
            distance = distance + (along / (axis * radius * seed_voxels)) ** 2
        pores |= distance < 1
    with h5py.File(path, "w") as file:
        file["labels"] = np.where(pores, 0, 1).astype(np.uint8)


def of_voxels(pore):
    """Volume and sphericity of the smoothed surface: that of the voxels themselves has steps, half as large again."""
    vertices, triangles, _, _ = marching_cubes(gaussian_filter(np.pad(pore, 6).astype(float), 1.0), 0.5)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    volume = abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6
    return volume, np.pi ** (1 / 3) * (6 * volume) ** (2 / 3) / mesh_surface_area(vertices, triangles)


def compare(path, voxel, table):
    with h5py.File(path) as file:
        pores = label(file["labels"][:] == 0, connectivity=1)
    with open(table) as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == pores.max() == len(SHAPES), (len(rows), pores.max())
    centres = np.array([[float(row[f"centre_{axis} [mm]"]) for axis in "xyz"] for row in rows])
    wrong = []
    for number in range(1, pores.max() + 1):
        voxels = np.argwhere(pores == number)
        middle = (voxels.mean(axis=0)[::-1] + 0.5) * voxel
        row = rows[np.linalg.norm(centres - middle, axis=1).argmin()]
        low, high = voxels.min(axis=0), voxels.max(axis=0) + 1
        volume, sphericity = of_voxels(pores[tuple(map(slice, low, high))] == number)
        off = float(row["volume_corrected [mm^3]"]) / (volume * voxel**3) - 1, float(row["sphericity [-]"]) - sphericity
        print(f"pore {number}: sphericity {sphericity:.3f}; volume {100 * off[0]:+.1f} %, sphericity {off[1]:+.3f}")
        if abs(off[0]) > 0.05 or abs(off[1]) > 0.05:
            wrong.append(number)
    assert not wrong, f"pores {wrong} are off by more than 5 % in volume or 0.05 in sphericity"


if sys.argv[1] == "image":
    write_image(float(sys.argv[2]), sys.argv[3])
else:
    compare(sys.argv[2], float(sys.argv[3]), sys.argv[4])
