#!/usr/bin/python3
"""Writes small valid files of each format, for the fuzzer to start from.

usage: seeds.py FOLDER          FOLDER/a.tif/..., FOLDER/a.nrrd/... are written: folders with the name that a file of
                                its kind has when it is read
"""
import gzip
import pathlib
import sys
import zlib

import h5py
import numpy as np
from vtk import vtkImageData, vtkTIFFWriter
from vtkmodules.util.numpy_support import numpy_to_vtk

folder = pathlib.Path(sys.argv[1])
voxels = np.arange(24, dtype=np.uint8).reshape(4, 3, 2)


def put(kind, name, content):
    (folder / kind).mkdir(parents=True, exist_ok=True)
    (folder / kind / name).write_bytes(content if isinstance(content, bytes) else content.encode())


for number, (kind, compression) in enumerate([(np.uint8, 0), (np.uint16, 1), (np.float32, 3), (np.int16, 0)]):
    image = vtkImageData()
    image.SetDimensions(2, 3, 4)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.astype(kind).ravel(), deep=True))
    writer = vtkTIFFWriter()
    writer.SetInputData(image)
    writer.SetCompression(compression)
    (folder / "a.tif").mkdir(parents=True, exist_ok=True)
    writer.SetFileName(str(folder / "a.tif" / f"{number}.tif"))
    writer.Write()
meta = "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 2 3 4\nElementSpacing = 1 1 2\nElementType = MET_UCHAR\n"
put("a.mha", "local", meta.encode() + b"ElementDataFile = LOCAL\n" + voxels.tobytes())
put("a.mha", "packed", meta.encode() + b"CompressedData = True\nElementDataFile = LOCAL\n" + zlib.compress(voxels.tobytes()))
put("a.mha", "beside", meta + "HeaderSize = -1\nElementDataFile = data\n")
put("a.mha", "list", meta + "ElementDataFile = LIST\ndata\ndata\n")
put("a.mha", "pattern", meta + "ElementDataFile = a%03d.raw 1 4 1\n")
nrrd = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nendian: little\nspace units: \"um\" \"um\" \"um\"\n"
put("a.nrrd", "raw", nrrd + b"spacings: 1 1 2\nencoding: raw\n\n" + voxels.tobytes())
put("a.nrrd", "packed", nrrd + b"space directions: (1,0,0) (0,1,0) (0,0,2)\nencoding: gzip\n\n" + gzip.compress(voxels.tobytes()))
put("a.nrrd", "beside", nrrd + b"encoding: raw\nbyte skip: -1\ndata file: data\n")
put("a.raw.info", "info", "NUM_X = 2\nNUM_Y = 3\nNUM_Z = 4\nvoxelSize = 2.4\nBYTEORDER = LOWBYTEFIRST\n")
put("a.raw.xml", "xml", "<tomodb2><v><SIZEX>2</SIZEX><SIZEY>3</SIZEY><SIZEZ>4</SIZEZ><BYTE_ORDER>LOW</BYTE_ORDER></v></tomodb2>")
(folder / "a.h5").mkdir(parents=True, exist_ok=True)
with h5py.File(folder / "a.h5" / "chunked", "w", libver="latest") as file:
    data = file.create_dataset("exchange/data", data=voxels, chunks=(2, 2, 2), compression="gzip")
    data.attrs["element_size_um"] = [2.0, 1.0, 1.0]
put("a.vdb", "start", b" BDV" + bytes(8))
