"""write_tiff(path, labels): an uncompressed multipage TIFF of 32-bit integers from a [z][y][x] array."""
import struct

import numpy as np


def write_tiff(path, labels):
    labels = np.asarray(labels, dtype="<u4")
    depth, height, width = labels.shape
    with open(path, "wb") as file:
        file.write(b"II*\0" + struct.pack("<I", 8))
        for k in range(depth):
            entries = [(256, 4, width), (257, 4, height), (258, 3, 32), (259, 3, 1), (262, 3, 1), (273, 4, 0),
                       (277, 3, 1), (278, 4, height), (279, 4, 4 * width * height), (339, 3, 1)]
            start = file.tell()
            data = start + 2 + 12 * len(entries) + 4
            end = data + 4 * width * height
            file.write(struct.pack("<H", len(entries)))
            for tag, kind, value in entries:
                file.write(struct.pack("<HHII", tag, kind, 1, data if tag == 273 else value))
            file.write(struct.pack("<I", 0 if k == depth - 1 else end))
            file.write(labels[k].tobytes())
