#!/usr/bin/python3
"""S_f of ellipsoids cut out of random packings, against their particles: what object_shapes measures, and the same with
d^2/20 a particle added to the moments. The plot also shows what inclusion.py left in FOLDER.

usage: shape_factor.py BIN [--out FOLDER] [--places N] [--most PARTICLES]
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from ellipsoid_packing import ellipsoid, read_brick, write_objects

FACTORS = (0.3, 0.6, 1.0, 1.7, 3.0)
PARTICLES = (100, 200, 500, 1000, 2000, 5000, 10000, 20000)
# What the thesis' text says of its figure 12.9b: S_f of a pressed inclusion against one of 1e5 particles.
THESIS = ((500, 10.0), (2000, 1.0))

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path, help="folder of the executables")
parser.add_argument("--out", type=pathlib.Path, help="folder of shape_factor.csv and shape_factor.png [BIN/../bench]")
parser.add_argument("--places", type=int, default=10, help="ellipsoids of each kind in each packing")
parser.add_argument("--most", type=int, default=20000, help="largest number of particles")
options = parser.parse_args()
out = options.out or options.bin / "../bench"
out.mkdir(parents=True, exist_ok=True)


def measured(table, packing):
    """S_f of the objects, and with the size of the particles added."""
    with open(table) as file:
        rows = list(csv.DictReader(file))
    radius = read_brick(packing)[2]
    plain, added = [], []
    for row in rows:
        moments = np.zeros((3, 3))
        for axis in "abc":
            direction = np.array([float(row[f"direction_{axis}_{c} [-]"]) for c in "xyz"])
            moments += float(row[f"semi_axis_{axis} [mm]"]) ** 2 / 5 * np.outer(direction, direction)
        root = np.sqrt(np.diag(moments) + (2 * radius) ** 2 / 20)
        plain.append(float(row["shape_factor [-]"]))
        added.append(root[2] / (0.5 * (root[0] + root[1])))
    return np.array(plain), np.array(added)


random = np.random.default_rng(1)
results = []
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    for density in (0.64, 0.70):
        bricks = []
        for seed in (1, 2, 3):
            path = folder / f"brick{seed}.h5"
            subprocess.run([options.bin / "packgen", path, "--particles", "5000", "--density", str(density),
                            "--random-seed", str(seed), "--quiet"], check=True)
            bricks.append(read_brick(path))
        for particles in PARTICLES:
            if particles > options.most:
                continue
            for factor in FACTORS:
                objects = [ellipsoid(brick, particles, factor, random) for brick in bricks
                           for _ in range(options.places)]
                packing, table = folder / "objects.h5", folder / "objects.csv"
                write_objects(packing, objects, bricks[0][2])
                subprocess.run([options.bin / "object_shapes", packing, table, "--quiet"], check=True)
                plain, added = measured(table, packing)
                results.append({"density": density, "particles": particles, "shape_factor": factor,
                                "error": plain.mean() / factor - 1, "deviation": plain.std() / factor,
                                "worst": np.abs(plain / factor - 1).max(), "error_added": added.mean() / factor - 1})
                print(f"D {density:.2f}  {particles:6} particles  S_f {factor:3.1f}  error "
                      f"{100 * results[-1]['error']:+6.2f} +- {100 * results[-1]['deviation']:5.2f} %  worst "
                      f"{100 * results[-1]['worst']:5.2f} %  with d^2/20 {100 * results[-1]['error_added']:+6.2f} %",
                      flush=True)

with open(out / "shape_factor.csv", "w", newline="") as file:
    writer = csv.DictWriter(file, results[0].keys())
    writer.writeheader()
    writer.writerows(results)


def of_all(row_filter, key):
    return float(np.sqrt(np.mean([row[key] ** 2 for row in results if row_filter(row)])))


counts = sorted({row["particles"] for row in results})
print("\nerror of one S_f, root mean square over the shapes [%], and the largest bias of a shape [%]")
for density in (0.64, 0.70):
    for count in counts:
        chosen = [row for row in results if row["density"] == density and row["particles"] == count]
        rms = np.sqrt(np.mean([row["error"] ** 2 + row["deviation"] ** 2 for row in chosen]))
        print(f"D {density:.2f} {count:6} {100 * rms:6.2f} {100 * max(abs(row['error']) for row in chosen):6.2f} "
              f"with d^2/20 {100 * max(abs(row['error_added']) for row in chosen):6.2f}")

figure, axes = plt.subplots(figsize=(6, 4))
for density, colour in ((0.64, "tab:blue"), (0.70, "tab:orange")):
    chosen = [[row for row in results if row["density"] == density and row["particles"] == count] for count in counts]
    axes.loglog(counts, [100 * np.sqrt(np.mean([r["error"] ** 2 + r["deviation"] ** 2 for r in rows])) for rows in chosen],
                "o-", color=colour, label=f"one ellipsoid, D = {density:.2f}")
    axes.loglog(counts, [100 * max(abs(r["error_added"]) for r in rows) for rows in chosen], ":", color=colour,
                label=f"bias with d²/20 added, D = {density:.2f}")
if (out / "inclusion.csv").exists():
    pressed = list(csv.DictReader(open(out / "inclusion.csv")))[:-1]  # the last is the reference
    axes.loglog([float(row["particles"]) for row in pressed],
                [float(row["error_root_mean_square [%]"]) for row in pressed], "D-", color="tab:green",
                label="pressed inclusion, strain 0.3")
axes.loglog(*zip(*THESIS), "ks", label="thesis, pressed inclusion")
axes.set_xlabel("particles")
axes.set_ylabel("error of S_f [%]")
axes.grid(which="both", alpha=0.3)
axes.legend(fontsize=8)
figure.tight_layout()
figure.savefig(out / "shape_factor.png", dpi=110)
