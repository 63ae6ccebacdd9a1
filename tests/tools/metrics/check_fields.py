#!/usr/bin/python3
"""Fails unless a file of local_stress or local_strain holds what numpy makes of the run by all pairs.

usage: check_fields.py stress RUN.h5 FIELDS.h5 FRAME ball|gaussian RADIUS
       check_fields.py strain RUN.h5 FIELDS.h5 FRAME REFERENCE RADIUS
"""
import sys

import h5py
import numpy as np


def field(path, name, frame):
    with h5py.File(path) as file:
        return file[f"particles/all/{name}/value"][frame]


def distances(points):
    return np.linalg.norm(points[:, None] - points[None], axis=2)


def check_stress(run, fields, frame, kernel, radius):
    apart = distances(field(run, "position", frame))
    if kernel == "ball":
        weight = (apart < radius).astype(float)
    else:
        weight = np.where(apart < 1.5 * radius, np.exp(-2.5 * (apart / radius) ** 2), 0.0)
    mean = weight @ field(run, "stress", frame) / weight.sum(axis=1)[:, None]
    assert np.allclose(field(fields, "stress_average", frame), mean, rtol=1e-10, atol=1e-3)
    xx, yy, zz, xy, xz, yz = mean.T
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)
    trace = np.trace(tensor, axis1=1, axis2=2)
    deviator = tensor - trace[:, None, None] / 3 * np.eye(3)
    mises = np.sqrt(1.5 * (deviator ** 2).sum(axis=(1, 2)))
    assert np.allclose(field(fields, "stress_equivalent", frame)[:, 0], np.sign(trace) * mises, rtol=1e-8, atol=1e-3)
    assert np.allclose(field(fields, "pressure", frame)[:, 0], -trace / 3, rtol=1e-8, atol=1e-3)


def check_strain(run, fields, frame, reference, radius):
    before, now = field(run, "position", int(reference)), field(run, "position", frame)
    near = distances(before) < radius
    for i in range(0, len(now), 7):
        others = np.flatnonzero(near[i] & (np.arange(len(now)) != i))
        old, new = before[others] - before[i], now[others] - now[i]
        spread = np.linalg.eigvalsh(old.T @ old)
        found = field(fields, "strain_linear", frame)[i]
        if len(others) < 4 or spread[0] <= 0.01 * spread[2]:
            assert np.isnan(found).all()
            continue
        gradient, residual = np.linalg.lstsq(old, new, rcond=None)[:2]
        F = gradient.T
        linear = (F + F.T) / 2 - np.eye(3)
        order = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])
        assert np.allclose(found, linear[order], atol=1e-9), (i, found, linear)
        values, vectors = np.linalg.eigh(F @ F.T)
        true = vectors @ np.diag(np.log(values) / 2) @ vectors.T
        assert np.allclose(field(fields, "strain", frame)[i], true[order], atol=1e-9)
        assert np.isclose(field(fields, "strain_volumetric", frame)[i, 0], np.log(np.linalg.det(F)), atol=1e-9)
        rest = ((new - old @ gradient) ** 2).sum() / len(others)
        assert np.isclose(field(fields, "non_affine", frame)[i, 0], rest, atol=1e-9)  # diameter 1


if __name__ == "__main__":
    kind, run, fields, frame, choice, radius = sys.argv[1:]
    (check_stress if kind == "stress" else check_strain)(run, fields, int(frame), choice, float(radius))
