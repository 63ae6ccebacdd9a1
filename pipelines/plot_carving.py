#!/usr/bin/python3
"""Draws the table that carve leaves of its iterations: volume, errors, overlap and particles taken out.

usage: plot_carving.py CARVED.csv PLOT.png
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

if len(sys.argv) != 3:
    sys.exit(__doc__.strip())
table, picture = sys.argv[1:]
with open(table) as file:
    rows = [{name.split(" [")[0]: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
if not rows:
    sys.exit(f"plot_carving.py: '{table}' has no row yet")
iteration = [row["iteration"] for row in rows]


def curve(axes, name, label, scale=1.0, **style):
    axes.plot(iteration, [scale * row[name] for row in rows], "o-", label=label, **style)


figure, ((volume, error), (overlap, taken)) = plt.subplots(2, 2, figsize=(9, 6.5), sharex=True, layout="constrained")
curve(volume, "volume", "sample", color="#d55e00")
curve(volume, "target", "image", color="#28303c")
volume.set_ylabel("volume of the closed pores [mm³]")
volume.legend()
curve(error, "total_error", "all, alpha shape", 100, color="#d55e00")
curve(error, "grid_error", "all, grid", 100, color="#0072b2")
if any(row["judged"] for row in rows):
    curve(error, "worst_error", "worst judged pore", 100, color="#9aa3af")
error.axhline(0, color="#28303c", lw=0.8)
error.set_yscale("symlog", linthresh=1)
error.set_ylabel("error of the volume [%]")
error.legend()
curve(overlap, "iou", "", color="#d55e00")
overlap.set_ylim(0, 1)
overlap.set_ylabel("intersection over union")
taken.bar(iteration, [row["removed"] for row in rows], color="#9aa3af")
taken.set_ylabel("particles taken out")
for axes in (overlap, taken):
    axes.set_xlabel("iteration")
    axes.xaxis.get_major_locator().set_params(integer=True)
figure.savefig(picture, dpi=120)
