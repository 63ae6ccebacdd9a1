#!/usr/bin/python3
"""Reads a file through its XDMF sidecar and through h5py, and fails where a number differs.

usage: read_xdmf.py xdmf2|xdmf3|plain NAME.xdmf NAME.h5

xdmf2, xdmf3  VTK's two readers, both of which ParaView offers. Debian's python3-vtk9 is built without them, Debian's
              python3-paraview has them. Exit status 3: not installed.
plain         follows the XML and fetches the arrays it names.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np


def grids_of_vtk(kind, name):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    if kind == "xdmf2":
        from vtkmodules.vtkIOXdmf2 import vtkXdmfReader as Reader
    else:
        from vtkmodules.vtkIOXdmf3 import vtkXdmf3Reader as Reader
    reader = Reader()
    reader.SetFileName(os.path.abspath(name))
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    times = [information.Get(Pipeline.TIME_STEPS(), i) for i in range(information.Length(Pipeline.TIME_STEPS()))]
    for time in times or [None]:  # xdmf3 gives a single grid no time
        if time is None:
            reader.Update()
        else:
            reader.UpdateTimeStep(time)
        data = reader.GetOutputDataObject(0)
        while data.IsA("vtkMultiBlockDataSet"):
            assert data.GetNumberOfBlocks() == 1, f"{data.GetNumberOfBlocks()} blocks at time {time}"
            data = data.GetBlock(0)
        assert data.GetNumberOfCells() == data.GetNumberOfPoints(), "not one vertex a particle"
        assert data.GetCell(1).GetNumberOfPoints() == 1 and data.GetCell(1).GetPointId(0) == 1
        arrays = data.GetPointData()
        # Copies: the arrays of xdmf3 lie in memory of the reader.
        yield time, vtk_to_numpy(data.GetPoints().GetData()).copy(), {
            arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)).copy() for i in range(arrays.GetNumberOfArrays())}


def array_of(item, folder):
    shape = [int(word) for word in item.get("Dimensions").split()]
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
        points = array_of(grid.find("Geometry/DataItem"), folder)
        topology = grid.find("Topology")
        assert topology.get("TopologyType") == "Polyvertex" and int(topology.get("NumberOfElements")) == len(points)
        assert np.array_equal(array_of(topology.find("DataItem"), folder), np.arange(len(points)))
        yield float(grid.find("Time").get("Value")), points, {
            attribute.get("Name"): array_of(attribute.find("DataItem"), folder) for attribute in grid.findall("Attribute")}


def main(kind, xdmf, h5):
    try:
        grids = list(grids_of_plain(xdmf) if kind == "plain" else grids_of_vtk(kind, xdmf))
    except ImportError as error:
        print(error, file=sys.stderr)
        return 3
    with h5py.File(h5) as file:
        particles = file["particles/all"]
        value, time = particles["position/value"], particles["position/time"]
        assert len(grids) == len(time), f"{len(grids)} grids for {len(time)} frames"
        for frame, (grid_time, points, arrays) in enumerate(grids):
            assert grid_time in (None, time[frame]), f"time {grid_time} instead of {time[frame]}"
            assert points.dtype == np.float64 and np.array_equal(points, value[frame]), f"positions of frame {frame}"
            for name in ("species", "id", "object"):
                assert (name in arrays) == (name in particles), f"array {name}"
                if name in particles:
                    assert np.array_equal(arrays[name], particles[name]), f"values of {name} in frame {frame}"
            for name, group in particles.items():
                if name != "position" and isinstance(group, h5py.Group) and "value" in group:
                    assert np.array_equal(np.squeeze(arrays[name]), np.squeeze(group["value"][frame])), f"field {name}"
        print(f"{kind}: {len(grids)} frames of {len(points)} particles")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
