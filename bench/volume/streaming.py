#!/usr/bin/python3
"""Reading and labelling a stack of 2000 x 2000 x 500 voxels of 8 bits (2 GB): rate and peak memory.

usage: streaming.py BIN BENCH [--folder F] [--keep]       BENCH holds bench_read_volume

Phantoms of 500^3 voxels, repeated 4 x 4 times: a foam of 7 % and a composite of 30 % inclusions; the foam as grey values
with noise as well. As raw voxels with a MetaImage header, and as an ImageJ stack of one page. What the same file costs to
read without doing anything (from the page cache), and to copy in memory, is measured in the same minute.
"""
import argparse
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time

import numpy as np
from vtk import vtkTIFFReader
from vtkmodules.util.numpy_support import vtk_to_numpy

TILE, REPEATS = 500, 4
EDGE = TILE * REPEATS


def voxels_of(tiff):
    reader = vtkTIFFReader()
    reader.SetFileName(str(tiff))
    reader.SetOrientationType(1)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(TILE, TILE, TILE).astype(np.uint8)


def slices(tile, noise):
    random = np.random.default_rng(1)
    speckle = random.normal(0, 20, (EDGE, EDGE)) if noise else None
    for page in tile:
        whole = np.tile(page, (REPEATS, REPEATS))
        if noise:
            whole = np.clip(60 + 100 * whole.astype(np.float32) + np.roll(speckle, random.integers(EDGE), 1), 0, 255)
        yield np.ascontiguousarray(whole.astype(np.uint8))


def write_raw(path, pages):
    data = path.with_suffix(".raw_")
    with open(data, "wb") as file:
        for page in pages:
            page.tofile(file)
    path.write_text(f"NDims = 3\nDimSize = {EDGE} {EDGE} {TILE}\nElementType = MET_UCHAR\nElementDataFile = {data.name}\n")
    return data


def write_imagej(path, raw):
    """One directory, then the planes of all slices, as ImageJ writes large stacks."""
    text = f"ImageJ=1.53t\nimages={TILE}\nslices={TILE}\n".encode().ljust(200, b"\0")
    entries = [(256, 4, 1, EDGE), (257, 4, 1, EDGE), (258, 3, 1, 8), (262, 3, 1, 1), (270, 2, 200, 0), (273, 4, 1, 0),
               (277, 3, 1, 1), (278, 4, 1, EDGE), (279, 4, 1, EDGE * EDGE)]
    at = 8 + 2 + 12 * len(entries) + 4
    fields = {270: at, 273: at + 200}
    with open(path, "wb") as file, open(raw, "rb") as planes:
        file.write(b"II*\0" + struct.pack("<IH", 8, len(entries)))
        for tag, kind, count, value in entries:
            file.write(struct.pack("<HHII", tag, kind, count, fields.get(tag, value)))
        file.write(struct.pack("<I", 0) + text)
        shutil.copyfileobj(planes, file, 1 << 24)


def limits(path):
    """Million voxels/s of reading the file and of copying it in memory, on one core."""
    start = time.perf_counter()
    count = 0
    with open(path, "rb", buffering=0) as file:
        block = bytearray(1 << 25)
        while got := file.readinto(block):
            count += got
    read = count / (time.perf_counter() - start) / 1e6
    source, target = np.ones(1 << 28, np.uint8), np.zeros(1 << 28, np.uint8)
    start = time.perf_counter()
    np.copyto(target, source)
    return read, source.size / (time.perf_counter() - start) / 1e6


parser = argparse.ArgumentParser()
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("bench", type=pathlib.Path)
parser.add_argument("--folder", type=pathlib.Path)
parser.add_argument("--keep", action="store_true")
arguments = parser.parse_args()
folder = arguments.folder or pathlib.Path(tempfile.mkdtemp(prefix="tomodem-bench-"))
folder.mkdir(exist_ok=True)
cases = {
    "foam of 7 %": ("phantom_foam", ["--relative-density", "0.07", "--cells", "3"], []),
    "composite, 30 % inclusions": ("phantom_inclusions", ["--fraction", "0.3", "--diameter", "20um:60um"], []),
    "foam of 7 %, grey with noise": ("phantom_foam", ["--relative-density", "0.07", "--cells", "3"], ["110"]),
}
try:
    for number, (name, (tool, options, threshold)) in enumerate(cases.items()):
        tiff = folder / f"{tool}.tif"
        if not tiff.exists():
            subprocess.run([arguments.bin / tool, tiff, "--size", str(TILE), "--voxel-size", "1um", "--quiet", *options],
                           check=True)
        header = folder / f"case{number}.mhd"
        raw = write_raw(header, slices(voxels_of(tiff), bool(threshold)))
        files = {"raw voxels": header}
        if number == 0:
            files["ImageJ stack"] = folder / "case.tif"
            write_imagej(files["ImageJ stack"], raw)
        for kind, file in files.items():
            for _ in range(3):
                read, copy = limits(raw)
                out = subprocess.run([arguments.bench / "bench_read_volume", file, *threshold], check=True,
                                     capture_output=True, text=True).stdout.strip()
                print(f"{name}, {kind}: {out}; the file alone {read:.0f}, a copy in memory {copy:.0f} million/s",
                      flush=True)
        raw.unlink()
finally:
    if not arguments.keep:
        shutil.rmtree(folder)
sys.exit(0)
