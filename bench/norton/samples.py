"""Samples of the benches of NORTON: labels of two phases in a brick, and the shape of the second phase in a run."""
import math

import h5py
import numpy as np

PHASES = {"A": (120.0, 3.05e-2), "B": (5020.0, 0.490)}  # K [MPa.s^M], M of the finite-element reference
INCLUSION = 0.20  # volume of phase B over that of the cube


def phase(name, label, norton, law="norton"):
    return f'[phase.{name}]\nlabel = {label}\nlaw = "{law}"\nnorton = {{ K = {norton[0]:g}, M = {norton[1]:g} }}\n'


def label(brick, case):
    """Gives the particles of a brick label 2 where the case (parallel, series, inclusion) has phase B, 1 elsewhere."""
    with h5py.File(brick, "r+") as file:
        group = file["particles/all"]
        points, origin, edges = group["position/value"][0], group["box/origin"][:], group["box/edges"][:]
        at = (points - origin) / edges - 0.5
        radius = (3 * INCLUSION / (4 * math.pi)) ** (1 / 3)
        inside = {"parallel": at[:, 0] < 0, "series": at[:, 2] < 0, "inclusion": (at**2).sum(axis=1) < radius**2}[case]
        group["species"][:] = np.where(inside, 2, 1)


def shape(run, strain, at):
    """S_f of phase B: semi-axis along the load over the mean of the others, from the inertia of its centres; at a strain
    of a run to `strain`, over that at the start."""
    with h5py.File(run) as file:
        group = file["particles/all"]
        of_b = group["species"][:] == 2
        frames = group["position/value"]
        factors = []
        for frame in frames:
            deviation = frame[of_b].std(axis=0)
            factors.append(2 * deviation[2] / (deviation[0] + deviation[1]))
        return float(np.interp(at, np.linspace(0, strain, len(factors)), factors)) / factors[0]


def reference(folder, name, at):
    """A value of a curve of the finite elements at a strain."""
    strain, value = np.loadtxt(folder / name, delimiter=",").T[:2]
    return float(np.interp(at, strain, value))
