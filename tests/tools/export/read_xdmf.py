#!/usr/bin/python3
"""Reads a file through its XDMF sidecar and through h5py, and fails where a number differs.

usage: read_xdmf.py vtk|plain NAME.xdmf NAME.h5

vtk    VTK's vtkXdmfReader, the one that ParaView offers first. Debian's python3-vtk9 is built without it, Debian's
       python3-paraview has it. Exit status 3: it is not installed.
plain  follows the XML and fetches the arrays it names.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np


def grids_of_vtk(name):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
    reader = vtkXdmfReader()
    reader.SetFileName(name)
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    for time in [information.Get(Pipeline.TIME_STEPS(), i) for i in range(information.Length(Pipeline.TIME_STEPS()))]:
        reader.UpdateTimeStep(time)
        data = reader.GetOutputDataObject(0)
        while data.IsA("vtkMultiBlockDataSet"):
            assert data.GetNumberOfBlocks() == 1, f"{data.GetNumberOfBlocks()} blocks at time {time}"
            data = data.GetBlock(0)
        assert data.GetNumberOfCells() == data.GetNumberOfPoints(), "not one vertex a particle"
        arrays = data.GetPointData()
        yield time, vtk_to_numpy(data.GetPoints().GetData()), {
            arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}


def array_of(item, folder):
    shape = [int(word) for word in item.get("Dimensions").split()]
    if item.get("ItemType") == "HyperSlab":
        selection, source = item.findall("DataItem")
        start, stride, count = np.array(selection.text.split(), int).reshape(3, -1)
        slab = tuple(slice(a, a + s * n, s) for a, s, n in zip(start, stride, count))
        return array_of(source, folder)[slab].reshape(shape)
    name, path = item.text.strip().split(":")
    assert not os.path.isabs(name), f"the path {name} is absolute"
    with h5py.File(os.path.join(folder, name)) as file:
        values = file[path][()]
    kind = {"Float": np.floating, "Int": np.integer}[item.get("NumberType")]
    assert np.issubdtype(values.dtype, kind) and values.dtype.itemsize == int(item.get("Precision")), path
    assert list(values.shape) == shape, f"{path} has the shape {values.shape}"
    return values


def grids_of_plain(name):
    folder = os.path.dirname(name)
    domain = ElementTree.parse(name).getroot().find("Domain")
    top = domain.findall("Grid")
    assert len(top) == 1
    collection = top[0].get("GridType") == "Collection"
    assert not collection or top[0].get("CollectionType") == "Temporal"
    for grid in top[0].findall("Grid") if collection else top:
        points = array_of(grid.find("Geometry/DataItem"), folder).reshape(-1, 3)
        topology = grid.find("Topology")
        assert topology.get("TopologyType") == "Polyvertex" and int(topology.get("NumberOfElements")) == len(points)
        yield float(grid.find("Time").get("Value")), points, {
            attribute.get("Name"): array_of(attribute.find("DataItem"), folder) for attribute in grid.findall("Attribute")}


def main(kind, xdmf, h5):
    try:
        grids = list({"vtk": grids_of_vtk, "plain": grids_of_plain}[kind](xdmf))
    except ImportError as error:
        print(error, file=sys.stderr)
        return 3
    with h5py.File(h5) as file:
        particles = file["particles/all"]
        value, time = particles["position/value"], particles["position/time"]
        assert len(grids) == len(time), f"{len(grids)} grids for {len(time)} frames"
        for frame, (grid_time, points, arrays) in enumerate(grids):
            assert grid_time == time[frame], f"time {grid_time} instead of {time[frame]}"
            assert points.dtype == np.float64 and np.array_equal(points, value[frame]), f"positions of frame {frame}"
            for name in ("species", "id", "object"):
                assert (name in arrays) == (name in particles), f"array {name}"
                if name in particles:
                    assert np.array_equal(arrays[name], particles[name]), f"values of {name} in frame {frame}"
        print(f"{kind}: {len(grids)} frames of {len(points)} particles")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
