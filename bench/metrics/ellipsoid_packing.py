"""Ellipsoids cut out of a periodic random packing, as the objects of one packing file."""
import h5py
import numpy as np


def read_brick(path):
    """Positions from the corner of the box, its edges, and the seed radius."""
    with h5py.File(path) as file:
        particles = file["particles/all"]
        edges = np.ravel(particles["box/edges"][()])[:3]
        position = particles["position/value"][0]
        if "origin" in particles["box"]:
            position = position - np.ravel(particles["box/origin"][()])[:3]
        return position, edges, float(particles.attrs["seed_radius"])


def ellipsoid(brick, particles, factor, random, turned=False):
    """Centres within an ellipsoid of semi-axes (w, w, factor w) that holds so many particles on average, anywhere in the
    packing, which is turned against it at random. `turned`: the ellipsoid too; its height then points anywhere."""
    position, edges, _ = brick
    volume = particles * edges.prod() / len(position)
    width = (0.75 * volume / np.pi / factor) ** (1 / 3)
    reach = width * max(1, factor)
    middle = random.random(3) * edges
    turn = random_turn(random)
    low, high = np.floor((middle - reach) / edges).astype(int), np.floor((middle + reach) / edges).astype(int)
    found = []
    for k in range(low[2], high[2] + 1):
        for j in range(low[1], high[1] + 1):
            for i in range(low[0], high[0] + 1):
                near = position + edges * (i, j, k) - middle
                near = near[(near**2).sum(axis=1) < reach**2] @ turn
                found.append(near[((near / (width, width, factor * width)) ** 2).sum(axis=1) < 1])
    centres = np.concatenate(found)
    return centres @ random_turn(random) if turned else centres


def random_turn(random):
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


def write_objects(path, objects, seed_radius):
    """A packing file with each set of centres as an object of its own, side by side."""
    placed, corner = [], 0.0
    for centres in objects:
        low = centres.min(axis=0)
        placed.append(centres - low + (corner, 0, 0))
        corner += np.ptp(centres[:, 0]) + 4 * seed_radius
    position = np.concatenate(placed)
    with h5py.File(path, "w") as file:
        file.create_group("h5md").attrs["version"] = np.array([1, 1], dtype="i4")
        group = file.create_group("particles/all")
        group.attrs["seed_radius"] = seed_radius
        group["species"] = np.ones(len(position), "i4")
        group["object"] = np.repeat(np.arange(1, len(objects) + 1, dtype="i4"), [len(part) for part in placed])
        group["id"] = np.arange(1, len(position) + 1)
        box = group.create_group("box")
        box.attrs["dimension"] = 3
        box.attrs["boundary"] = [b"none"] * 3
        box["edges"] = np.ptp(position, axis=0) + 4 * seed_radius
        box["origin"] = position.min(axis=0) - 2 * seed_radius
        frames = group.create_group("position")
        frames["value"] = position[None]
        frames["step"], frames["time"] = [0], [0.0]
