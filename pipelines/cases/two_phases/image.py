#!/usr/bin/python3
"""The image of a cube of phases A (label 1) and B (label 2).

usage: image.py parallel|series|inclusion IMAGE.mha        B is the half at low x, the half at low z, or a ball of 20 %
"""
import math
import pathlib
import sys

import numpy as np

VOXELS, EDGE = 100, 1.0  # mm
FRACTION = 0.2

case, image = sys.argv[1], pathlib.Path(sys.argv[2])
centres = (np.arange(VOXELS) + 0.5) / VOXELS - 0.5
z, y, x = np.meshgrid(centres, centres, centres, indexing="ij")
of_b = {"parallel": x < 0, "series": z < 0, "inclusion": x**2 + y**2 + z**2 < (3 * FRACTION / (4 * math.pi)) ** (2 / 3)}[case]
spacing = EDGE / VOXELS
header = (f"ObjectType = Image\nNDims = 3\nDimSize = {VOXELS} {VOXELS} {VOXELS}\nElementSpacing = {spacing} {spacing} {spacing}\n"
          "Offset = 0 0 0\nAnatomicalOrientation = RAI\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n")
part = image.with_suffix(".part")
part.write_bytes(header.encode() + (1 + of_b).astype(np.uint8).tobytes())
part.rename(image)
