#!/usr/bin/python3
"""Draws BILIN's master curve of a table beside the one that ships and the thesis' sigmoid.

usage: plot.py TABLE.toml SHIPPED.toml PICTURE.svg
"""
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# Thesis section 12.2 (docs/method.md): time step 5e-4 s, the low end at the flow stress of phase A over its stiffness.
A, B, C, D, TIME_STEP, LOW = 0.9048, 4.116, 3.651, 210.0, 5e-4, 0.0150


def bilin(path):
    with open(path, "rb") as file:
        return tomllib.load(file)["calibration"].get("bilin") or sys.exit(f"plot: '{path}' has no [calibration.bilin]")


def thesis(chi):
    return LOW * (A + B / (1 + np.exp(C - D * np.sqrt(chi * TIME_STEP))))


table, shipped = bilin(sys.argv[1]), bilin(sys.argv[2])
matplotlib.rcParams["svg.hashsalt"] = "tomodem"
figure, axis = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
chi = np.geomspace(5e-3, 41, 200)
axis.plot(chi, thesis(chi), "k--", lw=1, label="thesis' sigmoid, Δt = 5e-4 s")
axis.plot(shipped["chi"], shipped["flow"], "-", color="C0", lw=1.2, label="table that ships")
axis.errorbar(table["chi"], table["flow"], yerr=np.multiply(table["flow"], table["spread"]), fmt="o", ms=4, capsize=3,
              color="C1", label=f"this sweep: {table['packings']} packings of {table['particles'][0]:g} particles")
axis.set(xscale="log", yscale="log", xlabel="χ = rate t0² / Δt", ylabel="g = flow stress · 2 r_s / k_rep")
axis.grid(alpha=0.3, which="both", lw=0.4)
axis.legend()
figure.savefig(sys.argv[3], metadata={"Date": None})
