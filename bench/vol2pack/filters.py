#!/usr/bin/python3
"""What each filter of vol2pack does to spheres and rods of known volume and surface: a table, and a plot.

usage: filters.py BUILD [--out FOLDER] [--work W]
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build", type=pathlib.Path)
parser.add_argument("--out", type=pathlib.Path, help="folder of filters.csv and filters.png [BUILD/bench]")
parser.add_argument("--work", default="1", help="repetitions, 1: about three minutes")
options = parser.parse_args()
build = options.build.resolve()
out = options.out or build / "bench"
out.mkdir(parents=True, exist_ok=True)

with tempfile.TemporaryDirectory() as folder:
    bricks = [pathlib.Path(folder) / f"brick{seed}.h5" for seed in (1, 2, 3)]
    for seed, brick in enumerate(bricks, 1):
        subprocess.run([build / "bin/packgen", brick, "--particles", "5000", "--density", "0.70", "--random-seed",
                        str(seed), "--quiet"], check=True)
    text = subprocess.run([build / "bench/bench_vol2pack_filters", *bricks, "--work", options.work], check=True,
                          capture_output=True, text=True).stdout
(out / "filters.csv").write_text(text)
rows = [{key: value if key in ("body", "filter") else float(value) for key, value in row.items()}
        for row in csv.DictReader(text.splitlines())]
filters = list(dict.fromkeys(row["filter"] for row in rows))

for body in ("sphere", "rod"):
    for pixels in (1, 2, 4):
        chosen = [row for row in rows if row["body"] == body and row["pixels_per_seed"] == pixels]
        sizes = list(dict.fromkeys(row["diameters"] for row in chosen))
        print(f"\n{body}, {pixels} voxels per seed radius: volume error (scatter) / surface error / wrong labels [%]; "
              "L: times that nothing was left")
        print(f"{'particles across':16}" + "".join(f"{size:>26g}" for size in sizes))
        for name in filters:
            cells = []
            for row in (row for row in chosen if row["filter"] == name):
                lost = f" L{row['lost']:.0f}" if row["lost"] else ""
                cells.append(f"{100 * row['volume_error']:+.1f} ({100 * row['volume_scatter']:.1f}) / "
                             f"{100 * row['surface_error']:+.1f} / {100 * row['wrong_labels']:.1f}{lost}")
            print(f"{name:16}" + "".join(f"{cell:>26}" for cell in cells))

figure, axes = plt.subplots(3, 3, figsize=(13, 9), sharex=True)
for column, pixels in enumerate((1, 2, 4)):
    for row, (key, title) in enumerate((("volume_error", "volume error [%]"), ("surface_error", "surface error [%]"),
                                        ("wrong_labels", "wrong labels [% of the sphere]"))):
        for name in filters:
            points = [(entry["diameters"], 100 * entry[key]) for entry in rows if entry["body"] == "sphere"
                      and entry["pixels_per_seed"] == pixels and entry["filter"] == name]
            axes[row][column].plot(*zip(*points), marker=".", label=name, color="black" if name == "exact" else None)
        axes[row][column].set_xscale("log")
        axes[row][column].grid(alpha=0.3)
        axes[row][column].set_ylabel(title if column == 0 else "")
    axes[0][column].set_title(f"spheres, {pixels} voxels per seed radius")
    axes[2][column].set_xlabel("particles across")
axes[0][0].legend(fontsize=7)
figure.tight_layout()
figure.savefig(out / "filters.png", dpi=90)
print(f"\n{out / 'filters.csv'}, {out / 'filters.png'}")
