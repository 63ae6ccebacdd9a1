#!/usr/bin/python3
"""Compares mesh_recon's alpha shape with VTK's of the same points: volume of the tetrahedra, and of its own mesh.

usage: against_vtk.py PACKING.h5 MESH.vtp SUMMARY.json
"""
import json
import sys

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

packing, mesh, summary = sys.argv[1:]
summary = json.load(open(summary))
with h5py.File(packing) as file:
    position = file["particles/all/position/value"][0]

points = vtk.vtkPoints()
points.SetDataTypeToDouble()
points.SetData(numpy_to_vtk(position, deep=True, array_type=vtk.VTK_DOUBLE))
cloud = vtk.vtkPolyData()
cloud.SetPoints(points)
delaunay = vtk.vtkDelaunay3D()
delaunay.SetInputData(cloud)
delaunay.SetAlpha(summary["probe_radius"])
delaunay.SetTolerance(1e-9)
delaunay.SetOffset(10)
delaunay.AlphaTetsOn()
delaunay.AlphaTrisOff()
delaunay.AlphaLinesOff()
delaunay.AlphaVertsOff()
delaunay.Update()
cells = delaunay.GetOutput()
corners = vtk_to_numpy(cells.GetCells().GetConnectivityArray()).reshape(-1, 4)
place = vtk_to_numpy(cells.GetPoints().GetData())[corners].astype(float)
tetrahedra = np.abs(np.linalg.det(place[:, 1:] - place[:, :1])) / 6
outside = vtk.vtkGeometryFilter()
outside.SetInputData(cells)
triangles = vtk.vtkTriangleFilter()
triangles.SetInputConnection(outside.GetOutputPort())
theirs = vtk.vtkMassProperties()
theirs.SetInputConnection(triangles.GetOutputPort())

reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName(mesh)
ours = vtk.vtkMassProperties()
ours.SetInputConnection(reader.GetOutputPort())

errors = {"volume against the sum of VTK's tetrahedra": summary["volume"] / tetrahedra.sum() - 1,
          "volume against VTK's of our mesh": summary["volume"] / ours.GetVolume() - 1,
          "area against VTK's of our mesh": summary["area"] / ours.GetSurfaceArea() - 1,
          "area against VTK's of its surface": summary["area"] / theirs.GetSurfaceArea() - 1}
print(f"{len(position)} points, {len(tetrahedra)} tetrahedra:", ", ".join(f"{k} {v:+.1e}" for k, v in errors.items()))
bounds = (1e-9, 1e-6, 1e-6, 1e-6)
sys.exit(any(abs(error) > bound for error, bound in zip(errors.values(), bounds)))
