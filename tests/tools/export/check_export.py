#!/usr/bin/python3
"""Fails unless exported files hold the numbers that h5py reads in the frames they were made of.

usage: check_export.py dump|vtp|pvd FILE.h5 FRAME,FRAME... EXPORTED...
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np


def fields_of(particles):
    return [name for name in particles if name not in ("position", "box") and "value" in particles[name]]


def columns_of(particles, field):
    count = particles[field]["value"].shape[2]
    if field == "velocity":
        return ["vx", "vy", "vz"]
    endings = {1: [""], 3: ["_x", "_y", "_z"], 6: ["_xx", "_yy", "_zz", "_xy", "_xz", "_yz"]}[count]
    return [field + ending for ending in endings]


def check_dump(particles, frames, name):
    box = particles["box"]
    low = box["origin"][()]
    bounds = np.stack([low, low + box["edges"][()]], axis=1)
    flags = ["pp" if word.decode() == "periodic" else "ff" for word in box.attrs["boundary"]]
    count = len(particles["id"])
    with open(name) as file:
        for frame in frames:
            head = [file.readline().rstrip("\n") for _ in range(9)]
            assert head[0] == "ITEM: TIMESTEP" and int(head[1]) == particles["position/step"][frame]
            assert head[2] == "ITEM: NUMBER OF ATOMS" and int(head[3]) == count
            assert head[4] == "ITEM: BOX BOUNDS " + " ".join(flags)
            assert np.array_equal([[float(word) for word in line.split()] for line in head[5:8]], bounds)
            columns = [column for field in fields_of(particles) for column in columns_of(particles, field)]
            assert head[8] == "ITEM: ATOMS " + " ".join(["id type x y z radius object"] + columns), head[8]
            rows = np.array([[float(word) for word in file.readline().split()] for _ in range(count)])
            compare(particles, frame, rows[:, 2:5], {"id": rows[:, 0], "species": rows[:, 1], "radius": rows[:, 5]})
            objects = particles["object"][()] if "object" in particles else np.zeros(count)
            assert np.array_equal(rows[:, 6], objects)
            if columns:
                expected = np.hstack([particles[field]["value"][frame] for field in fields_of(particles)])
                assert np.array_equal(rows[:, 7:], expected, equal_nan=True), f"fields of frame {frame}"
        assert file.readline() == "", "more than the chosen frames"


def check_vtp(particles, frame, name):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(name)
    reader.Update()
    data = reader.GetOutput()
    assert data.GetNumberOfVerts() == data.GetNumberOfPoints() == len(particles["id"])
    assert data.GetCell(3).GetPointId(0) == 3
    point_data = data.GetPointData()
    arrays = {point_data.GetArrayName(i): vtk_to_numpy(point_data.GetArray(i))
              for i in range(point_data.GetNumberOfArrays())}
    assert ("object" in arrays) == ("object" in particles)
    for field in fields_of(particles):
        expected, found = particles[field]["value"][frame], arrays.pop(field).reshape(len(particles["id"]), -1)
        if expected.shape[1] == 6:  # VTK's order of a symmetric tensor
            expected = expected[:, [0, 1, 2, 3, 5, 4]]
        assert np.array_equal(found, expected, equal_nan=True), f"{field} of frame {frame}"
    compare(particles, frame, vtk_to_numpy(data.GetPoints().GetData()), arrays)


def check_pvd(particles, frames, name):
    sets = list(ElementTree.parse(name).getroot().find("Collection"))
    assert [float(entry.get("timestep")) for entry in sets] == [particles["position/time"][frame] for frame in frames]
    for entry in sets:
        assert os.path.exists(os.path.join(os.path.dirname(name), entry.get("file")))


def compare(particles, frame, points, arrays):
    assert np.array_equal(points, particles["position/value"][frame]), f"positions of frame {frame}"
    for key in arrays:
        expected = particles.attrs["seed_radius"] if key == "radius" and key not in particles else particles[key][()]
        assert np.all(arrays[key] == expected), f"{key} of frame {frame}"


def main(kind, h5, frames, *exported):
    frames = [int(word) for word in frames.split(",")]
    with h5py.File(h5) as file:
        particles = file["particles/all"]
        if kind == "dump":
            check_dump(particles, frames, *exported)
        elif kind == "pvd":
            check_pvd(particles, frames, *exported)
        else:
            assert len(frames) == len(exported)
            for frame, name in zip(frames, exported):
                check_vtp(particles, frame, name)


if __name__ == "__main__":
    main(*sys.argv[1:])
