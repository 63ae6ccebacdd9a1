"""Samples of any size for the measurements."""
import shutil

import h5py
import numpy as np


def tiled(brick, particles, path):
    """A sample of about `particles` from whole bricks, as near to a cube as they allow."""
    with h5py.File(brick) as file:
        group = file["particles/all"]
        points, edges = group["position/value"][0], group["box/edges"][:]
        copies = [1, 1, 1]
        while np.prod(copies) * len(points) < 0.99 * particles:
            copies[int(np.argmin(copies * edges))] += 1
        shifts = np.stack(np.meshgrid(*[np.arange(n) for n in copies], indexing="ij"), -1).reshape(-1, 3)
        many = (points[None] + (shifts * edges)[:, None]).reshape(-1, 3)
        if len(many) > 1.01 * particles:  # the lowest ones of a sample that is no multiple of a brick
            many = many[np.argsort(many[:, 2], kind="stable")[: int(particles)]]
        shutil.copy(brick, path)
    with h5py.File(path, "r+") as file:
        group = file["particles/all"]
        count = len(many)
        for name, values in (("position/value", many[None]), ("species", np.ones(count, np.int32)),
                             ("id", np.arange(1, count + 1))):
            kind, unit = group[name].dtype, dict(group[name].attrs)
            del group[name]
            group[name] = values.astype(kind)
            group[name].attrs.update(unit)
        top = many.max(axis=0) - many.min(axis=0)
        group["box/edges"][:] = top
        group.attrs["relaxed"] = np.int32(1)
        boundary = group["box"].attrs["boundary"]
        group["box"].attrs["boundary"] = np.array([b"none"] * 3, dtype=boundary.dtype)
    return count
