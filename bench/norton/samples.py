"""Samples of the benches of NORTON: labels of two phases in a brick, the shape of the second phase in a run, and what that
shape should be."""
import math

import h5py
import numpy as np
from scipy.spatial import ConvexHull, Voronoi

PHASES = {"A": (120.0, 3.05e-2), "B": (5020.0, 0.490)}  # K [MPa.s^M], M of the finite-element reference
INCLUSION = 0.20  # volume of phase B over that of the cube


def phase(name, label, norton, law="norton"):
    return f'[phase.{name}]\nlabel = {label}\nlaw = "{law}"\nnorton = {{ K = {norton[0]:g}, M = {norton[1]:g} }}\n'


def label(brick, case, share=None):
    """Gives the particles of a brick label 2 where the case has phase B, 1 elsewhere: one half of the brick (parallel,
    series), or a ball in its middle (inclusion) of that share of its volume."""
    with h5py.File(brick, "r+") as file:
        group = file["particles/all"]
        points, origin, edges = group["position/value"][0], group["box/origin"][:], group["box/edges"][:]
        at = (points - origin) / edges - 0.5
        radius = (3 * (share or INCLUSION) / (4 * math.pi)) ** (1 / 3)
        inside = {"parallel": at[:, 0] < 0, "series": at[:, 2] < 0, "inclusion": (at**2).sum(axis=1) < radius**2}[case]
        group["species"][:] = np.where(inside, 2, 1)


def shapes(run):
    """Strain (positive along the load) and S_f of phase B over that at the start, of every frame of a run. S_f is the
    semi-axis along the load over the mean of the others, from the inertia of the centres of the particles."""
    if not run.exists():  # it stopped before its first point
        return np.full(1, np.nan), np.full(1, np.nan)
    with h5py.File(run) as file:
        group, curve = file["particles/all"], file["observables/strain"]
        of_b = group["species"][:] == 2
        factors = []
        for frame in group["position/value"]:
            deviation = frame[of_b].std(axis=0)
            factors.append(2 * deviation[2] / (deviation[0] + deviation[1]))
        # A quasi-static frame is that of the first step at or after its strain.
        strain = np.abs(np.interp(group["position/time"][:], curve["time"][:], curve["value"][:]))
        return strain, np.array(factors) / factors[0]


def shape(run, at):
    """S_f at a strain of a run, over that at the start; NaN beyond the run's end."""
    strain, factors = shapes(run)
    return float(np.exp(np.interp(at, strain, np.log(factors)))) if strain[-1] > at - 1e-6 else math.nan


def frame_at(file, strain):
    """Index of the first frame of an open run at or after a strain (positive along the load), or of the last frame."""
    curve = file["observables/strain"]
    of_frames = np.abs(np.interp(file["particles/all/position/time"][:], curve["time"][:], curve["value"][:]))
    return int(np.searchsorted(of_frames[:-1], strain - 1e-9))


def volume_inside(run, strain, depth=4, most=2000):
    """Change of volume inside a run's material at a strain, over that at the start: of the mean Voronoi cell of particles
    that are more than `depth` seed radii inside the convex hull in both frames. The surface has no part in it."""
    with h5py.File(run) as file:
        frames, radius = file["particles/all/position/value"], file["particles/all"].attrs["seed_radius"]
        both = frames[0], frames[frame_at(file, strain)]
    inside = np.full(len(both[0]), True)
    for points in both:
        planes = ConvexHull(points).equations
        for normal_and_offset in planes:
            inside &= points @ normal_and_offset[:3] + normal_and_offset[3] < -depth * radius
    chosen = np.flatnonzero(inside)
    chosen = chosen[:: len(chosen) // most + 1]
    volumes = []
    for points in both:
        cells = Voronoi(points)
        volumes.append(sum(ConvexHull(cells.vertices[cells.regions[cells.point_region[k]]]).volume for k in chosen))
    return volumes[1] / volumes[0] - 1 if len(chosen) else math.nan


def spheroid(contrast, strain, share=0.0):
    """Height over diameter at a strain of compression of a sphere of viscous matter in a matrix of 1/contrast of its
    viscosity (M = 1): Bilby, Eshelby & Kundu, Tectonophysics 28 (1975) 265, integrated with the midpoint rule. With a
    share of the volume, that of Mori and Tanaka."""
    log_aspect, steps = 0.0, 1000
    for _ in range(steps):
        middle = log_aspect
        for _ in range(3):
            concentration = 1 / (1 + (contrast - 1) * _resistance(math.exp(middle)))
            slope = 1.5 * concentration / (1 - share + share * concentration)
            middle = log_aspect - slope * strain / steps / 2
        log_aspect -= slope * strain / steps
    return math.exp(log_aspect)


def _resistance(a):
    """Deviatoric axial component of Eshelby's tensor of an incompressible spheroid of aspect a, at most 1."""
    if abs(a - 1) < 1e-3:
        return 0.4 + (a - 1) * (_resistance(1.01) - _resistance(0.99)) / 0.02
    root = math.sqrt(abs(1 - a * a))
    turn = math.acos(a) - a * root if a < 1 else a * root - math.acosh(a)
    g = a * turn / root**3
    return 3 * (a * a - (a * a + 0.5) * g) / (a * a - 1)


def reference(folder, name, at, column=1):
    """A value of a curve of the finite elements at a strain."""
    table = np.loadtxt(folder / name, delimiter=",").T
    return float(np.interp(at, table[0], table[column]))
