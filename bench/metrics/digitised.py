#!/usr/bin/python3
"""S_f of ellipsoids drawn in voxels, against their size: what image_shapes measures, and with the h^2/12 of a voxel added.

usage: digitised.py BIN [--places N]
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import numpy as np
from ellipsoid_packing import random_turn

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path, help="folder of the executables")
parser.add_argument("--places", type=int, default=60, help="ellipsoids of each kind")
options = parser.parse_args()
random = np.random.default_rng(5)

with tempfile.TemporaryDirectory() as folder:
    image, table = pathlib.Path(folder) / "ellipsoids.raw", pathlib.Path(folder) / "out.csv"
    for factor in (0.3, 1.0, 3.0):
        for shortest in (3, 5, 10):
            width = shortest / min(1, factor)
            semi_axes = width * np.array([1, 1, factor])
            edge = 2 * int(np.ceil(semi_axes.max())) + 4
            turns, layers = [], []
            for _ in range(options.places):
                turn = random_turn(random)
                place = np.moveaxis(np.indices((edge,) * 3)[::-1], 0, -1) + 0.5 - edge / 2 - random.random(3)
                layers.append((((place @ turn) / semi_axes) ** 2).sum(axis=-1) < 1)
                turns.append(turn)  # its columns are the axes
            np.concatenate(layers).astype("u1").tofile(image)
            subprocess.run([options.bin / "image_shapes", image, table, "--raw-size",
                            f"{edge}x{edge}x{edge * options.places}", "--raw-type", "uint8", "--voxel-size", "1mm",
                            "--objects", "1", "--quiet"], check=True)
            plain, added = [], []
            for row, turn in zip(csv.DictReader(open(table)), turns, strict=True):
                moments = np.zeros((3, 3))
                for axis in "abc":
                    direction = np.array([float(row[f"direction_{axis}_{c} [-]"]) for c in "xyz"])
                    moments += float(row[f"semi_axis_{axis} [mm]"]) ** 2 / 5 * np.outer(direction, direction)
                own = np.diag(turn.T @ moments @ turn)  # along the ellipsoid's axes, where its S_f is known
                for values, moment in ((plain, own), (added, own + 1 / 12)):
                    root = np.sqrt(moment)
                    values.append(100 * (root[2] / (0.5 * (root[0] + root[1])) / factor - 1))
            print(f"S_f {factor:3.1f}, shortest semi-axis {shortest:2} voxels: error {np.mean(plain):+.2f} +- "
                  f"{np.std(plain):.2f} %, with h^2/12 {np.mean(added):+.2f} %")
