#!/usr/bin/python3
"""The volume of phantom pores, open, half closed and closed, by the three methods of `pores`.

usage: pores.py BUILD/bin [--across DIAMETERS] [--packings N]

Every pore is made from a ball: whole, flattened, gone, or cut by the face of the sample. The image is filled with
particles, measured, relaxed under BILIN and measured again, for N packings (random shifts and turns of one brick). Prints
the error of each method in percent of the volume of the ball, mean and standard deviation; "two probes" also with the
closed sample of the same packing taken off, as in the thesis.
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

VOXELS, FACE = 120, 2.0  # of the cube's edge; its half edge in radii of the ball
SCENE = """seed_radius = 0.5
[phase.solid]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[load]
axis = "z"
steps = [ { strain = -0.1, rate = 1e-3 } ]
"""


def ellipsoid(half_height):
    return lambda x, y, z: x**2 + y**2 + (z / half_height) ** 2 < 1


def ball_at(height):
    return lambda x, y, z: x**2 + y**2 + (z - height) ** 2 < 1


PHANTOMS = {
    "ball": ellipsoid(1.0),
    "half closed: flattened to 1/2": ellipsoid(0.5),
    "half closed: flattened to 1/4": ellipsoid(0.25),
    "closed": lambda x, y, z: np.zeros(np.broadcast(x, y, z).shape, bool),
    "open: bottle": ball_at(FACE - 0.6),
    "open: half ball in the face": ball_at(FACE),
    "open: blind hole": lambda x, y, z: (x**2 + y**2 < 0.49) & (z > FACE - 2),
}
METHODS = {"lids": "lids", "two probes": "two-probes", "outward vectors": "outward-vectors"}


def volume(binary, sample, method):
    table = sample.with_suffix(".csv")
    subprocess.run([binary / "pores", sample, table, "--method", METHODS[method], "--quiet"], check=True,
                   stderr=subprocess.DEVNULL)
    with open(table, newline="") as file:
        row = next(csv.DictReader(file))
    return float(row["volume_corrected [mm^3]"] or row["volume [mm^3]"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", type=pathlib.Path)
    parser.add_argument("--across", type=float, default=14, help="the ball, in particle diameters")
    parser.add_argument("--packings", type=int, default=3)
    options = parser.parse_args()
    voxel = 2 * FACE / VOXELS  # ball's radii; written as mm
    pixels_per_seed = 1 / voxel / options.across
    at = (np.arange(VOXELS) + 0.5) * voxel - FACE
    z, y, x = at[:, None, None], at[None, :, None], at[None, None, :]
    errors = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        brick, scene, image = folder / "brick.h5", folder / "scene.toml", folder / "image.h5"
        scene.write_text(SCENE)
        subprocess.run([options.binary / "packgen", brick, "--particles", "20000", "--density", "0.64", "--quiet"], check=True)
        for packing in range(options.packings):
            closed = {}
            for name in ["closed"] + [name for name in PHANTOMS if name != "closed"]:
                pore = PHANTOMS[name](x, y, z)
                with h5py.File(image, "w") as file:
                    file["labels"] = np.where(pore, 0, 1).astype(np.uint8)
                truth, unit = pore.sum() * voxel**3, 4 / 3 * np.pi / 100
                sample, relaxed = folder / "sample.h5", folder / "relaxed.h5"
                subprocess.run([options.binary / "vol2pack", brick, f"{image}:/labels", sample, "--voxel-size", f"{voxel}mm",
                                "--pixels-per-seed", str(pixels_per_seed), "--random-seed", str(packing + 1), "--quiet"],
                               check=True, stderr=subprocess.DEVNULL)
                subprocess.run([options.binary / "relax", sample, scene, relaxed, "--quiet"], check=True,
                               stderr=subprocess.DEVNULL)
                for state, file in ("as cut", sample), ("relaxed", relaxed):
                    for method in METHODS:
                        measured = volume(options.binary, file, method)
                        if name == "closed":
                            closed[state, method] = measured
                        errors.setdefault((state, name, method), []).append((measured - truth) / unit)
                        if method == "two probes":
                            errors.setdefault((state, name, "less closed"), []).append(
                                (measured - closed[state, method] - truth) / unit)
    columns = ["lids", "two probes", "less closed", "outward vectors"]
    for state in "as cut", "relaxed":
        print(f"{state:32}" + "".join(f"{column:>20}" for column in columns))
        for name in PHANTOMS:
            print(f"{name:32}" + "".join(
                f"{np.mean(errors[state, name, column]):+12.1f} ± {np.std(errors[state, name, column]):5.1f}"
                for column in columns))


main()
