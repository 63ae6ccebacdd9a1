#!/usr/bin/python3
"""Prints the options with which stress_strain measures the flow stress of a run that ends before the strain where it does so
by default, 0.3: at the largest strain that the run reaches, over the last sixth of it (as 0.05 is of 0.3). Else nothing.

usage: flow_strain.py RUN
"""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1]) as run:
    strain = run["observables/strain/value"][()]
    largest = float(np.max(np.abs(strain[np.isfinite(strain)]), initial=0))
if 0 < largest < 0.295:  # as far as stress_strain still takes for 0.3
    print(f"--at {largest:.6g} --window {largest / 6:.6g}")
