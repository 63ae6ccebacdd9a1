#!/usr/bin/python3
"""Flow stress at strain 0.3, equilibrium error and volume change of one-phase runs, against what is wanted.

usage: flow_stress.py WANTED_MPA TOLERANCE RUN.h5 ...     (NAME.volume.csv beside each NAME.h5 where volume is checked)
"""
import csv
import os
import sys

import h5py
import numpy as np

wanted, tolerance = float(sys.argv[1]), float(sys.argv[2])
stresses, errors, volumes = [], [], []
for name in sys.argv[3:]:
    with h5py.File(name) as run:
        curve = {key: run[f"observables/{key}/value"][:] for key in ("strain", "stress_true", "equilibrium_error")}
    window = (curve["strain"] <= -0.25) & (curve["strain"] >= -0.35)
    stresses.append(-curve["stress_true"][window].mean() / 1e6)
    errors.append(curve["equilibrium_error"][window].mean())
    table = name.replace(".h5", ".volume.csv")
    if os.path.exists(table):
        rows = list(csv.DictReader(open(table)))
        column = next(key for key in rows[0] if key.startswith("volume_change"))
        volumes.append(float(rows[-1][column]))

mean, spread = np.mean(stresses), np.std(stresses, ddof=1) if len(stresses) > 1 else 0.0
print(f"# flow stress at 0.3: {mean:.1f} +- {spread:.1f} MPa over {len(stresses)} packings ({wanted:g} wanted, "
      f"{100 * (mean / wanted - 1):+.1f} %)")
print(f"# equilibrium error: {100 * np.mean(errors):.3f} % (largest {100 * np.max(errors):.3f} %)")
if volumes:
    print(f"# volume change at the end: {', '.join(f'{v:+.2%}' for v in volumes)}")
assert abs(mean / wanted - 1) < tolerance, "flow stress"
assert max(errors) < 0.002, "equilibrium error"
assert all(abs(v) < 0.08 for v in volumes), "volume change"
