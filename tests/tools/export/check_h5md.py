#!/usr/bin/python3
"""Fails unless a file written by `write_sample_run N F FILE` is H5MD 1.1 with the numbers that were put in.

usage: check_h5md.py N F FILE.h5
"""
import sys

import h5py
import numpy as np


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def main(count, frames, name):
    count, frames = int(count), int(frames)
    i = np.arange(count)
    with h5py.File(name) as file:
        assert list(file["h5md"].attrs["version"]) == [1, 1]
        assert text(file["h5md/author"].attrs["name"])
        assert text(file["h5md/creator"].attrs["name"]) == "tomodem write_sample_run"
        assert text(file["h5md/creator"].attrs["version"]) == "1.2.3"

        particles = file["particles/all"]
        box = particles["box"]
        assert box.attrs["dimension"] == 3
        assert [text(word) for word in box.attrs["boundary"]] == ["periodic", "periodic", "none"]
        assert list(box["edges"]) == [10, 12, 14] and list(box["origin"]) == [-1, 0.5, 0.25]
        assert text(box["edges"].attrs["unit"]) == "mm"
        assert particles.attrs["seed_radius"] == 0.5 and text(particles.attrs["seed_radius_unit"]) == "mm"
        assert particles.attrs["relaxed"] == 1

        value = particles["position/value"]
        assert value.shape == (frames, count, 3) and value.dtype == np.float64 and text(value.attrs["unit"]) == "mm"
        for frame in range(frames):
            expected = np.stack([0.1 * i, np.sqrt(i), -1.0 / (i + 1.0) - frame], axis=1)
            assert np.array_equal(value[frame], expected), f"frame {frame}"
        assert particles["species"].dtype == np.int32 and np.array_equal(particles["species"], 1 + i % 2)
        assert particles["id"].dtype == np.int64 and np.array_equal(particles["id"], 10 + 3 * i)
        assert particles["object"].dtype == np.int32 and np.array_equal(particles["object"], i % 5)

        f = np.arange(frames)
        for group, unit, expected in [(particles["position"], "mm", None),
                                      (file["observables/strain"], "", -0.01 * f),
                                      (file["observables/stress_true"], "Pa", -1e6 * f)]:
            assert np.array_equal(group["step"], 100 * f) and np.issubdtype(group["step"].dtype, np.integer)
            assert np.array_equal(group["time"], 0.5 * f) and text(group["time"].attrs["unit"]) == "s"
            assert text(group["value"].attrs["unit"]) == unit
            if expected is not None:
                assert text(group.attrs["unit"]) == unit and np.array_equal(group["value"], expected)

        parameters = file["parameters/tomodem"]
        stored = {key: text(parameters[key][()]) for key in parameters if key != "inputs"}
        assert stored == {"tool": "write_sample_run", "version": "1.2.3", "command_line": "write_sample_run a b",
                          "scene": "seed_radius = 0.5\n", "unit_system": "mm g s"}, stored
        assert [text(word) for word in parameters["inputs/name"]] == ["a b.tif", "c.toml"]
        assert [text(word) for word in parameters["inputs/sha256"]] == ["00ff", "11"]


if __name__ == "__main__":
    main(*sys.argv[1:])
