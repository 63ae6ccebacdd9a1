#!/usr/bin/python3
"""Compares the table of image_shapes with scikit-image's regionprops of the same voxels.

usage: against_skimage.py TABLE VOXEL_MM --labels LABEL [--min-voxels N] IMAGE.tif ...
"""
import argparse
import csv
import sys

import numpy as np
from PIL import Image, ImageSequence
from skimage.measure import label, regionprops

parser = argparse.ArgumentParser()
parser.add_argument("table")
parser.add_argument("voxel", type=float)
parser.add_argument("--labels", type=int, required=True)
parser.add_argument("--min-voxels", type=int, default=1)
parser.add_argument("images", nargs="+")
options = parser.parse_args()

voxels = np.array([np.array(page) for path in options.images for page in ImageSequence.Iterator(Image.open(path))])
regions = regionprops(label(voxels == options.labels, connectivity=3))
# What lies in one plane has no shape, and is left out by image_shapes.
regions = [region for region in regions if region.area >= options.min_voxels and np.linalg.matrix_rank(
    region.coords - region.coords.mean(axis=0)) == 3]
with open(options.table) as file:
    rows = list(csv.DictReader(file))
assert len(rows) == len(regions), f"{len(rows)} rows, {len(regions)} regions"

size = options.voxel
worst = {"voxels": 0, "centre": 0, "inertia tensor": 0, "major axis": 0, "minor axis": 0}


def note(name, error):
    worst[name] = max(worst[name], float(error))


for row, region in zip(rows, regions):
    number = lambda name: float(row[name])
    note("voxels", abs(int(row["voxels [-]"]) - region.area))
    centre = np.array([number(f"centre_{c} [mm]") for c in "xyz"])
    note("centre", np.abs(centre - (np.array(region.centroid)[::-1] + 0.5) * size).max() / size)
    axes = np.array([number(f"semi_axis_{a} [mm]") for a in "abc"])
    turn = np.array([[number(f"direction_{a}_{c} [-]") for c in "xyz"] for a in "abc"]).T
    moments = turn @ np.diag(axes**2 / 5) @ turn.T
    # Theirs is about z, y, x and of the moments about the axes: trace(M) - M.
    inertia = np.array(region.inertia_tensor)[::-1, ::-1] * size**2
    note("inertia tensor", np.abs(np.trace(moments) * np.eye(3) - moments - inertia).max() / np.trace(inertia))
    note("major axis", abs(2 * axes[0] / (region.axis_major_length * size) - 1))
    note("minor axis", abs(2 * axes[2] / (region.axis_minor_length * size) - 1))
print(f"{len(rows)} objects; largest difference:", ", ".join(f"{name} {error:.1e}" for name, error in worst.items()))
# The table has ten digits.
bounds = {"voxels": 0, "centre": 1e-6, "inertia tensor": 1e-8, "major axis": 1e-8, "minor axis": 1e-6}
sys.exit(any(error > bounds[name] for name, error in worst.items()))
