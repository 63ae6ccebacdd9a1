#!/usr/bin/python3
"""Compares the objects of separate_objects with scikit-image's watershed of the same phase.

usage: against_skimage.py IMAGE.tif LABEL OBJECTS.tif FIRST MIN_DEPTH [SLICE_SPACING]        both in edges of a voxel

Both take the distance map, its h-maxima as seeds, and neighbours that share a face. scikit-image floods the map with its
shallow maxima cut off, as otherwise the first that reaches one takes the whole of it. The two differ where two floods come at
the same time; so the objects must be as many, and the adjusted Rand index of the voxels above 0.99.
"""
import sys

import numpy as np
from scipy import ndimage
from skimage.morphology import local_maxima, reconstruction
from skimage.segmentation import watershed
from voxels import adjusted_rand_index, read

image, label, objects, first, depth = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4]), float(sys.argv[5])
edges = (float(sys.argv[6]) if len(sys.argv) > 6 else 1, 1, 1)
phase = read(image) == label
found = np.where(phase, read(objects).astype(np.int64) - first + 1, 0)
assert found[phase].min() == 1

faces = ndimage.generate_binary_structure(3, 1)
distance = np.where(phase, ndimage.distance_transform_edt(phase, sampling=edges), -1e4).astype(np.float32)
deep = reconstruction(distance - np.float32(depth), distance, footprint=faces)
seeds, count = ndimage.label(local_maxima(deep, connectivity=1) & phase, structure=faces)
expected = watershed(-deep, seeds, mask=phase)

index = adjusted_rand_index(found[phase], expected[phase])
print(f"objects: {found.max()}, scikit-image {count}; adjusted Rand index {index:.4f}")
assert found.max() == count
assert len(np.unique(found[phase])) == count
assert index > 0.99
# Every object is one piece, from 1 on in the order of first voxels.
assert ndimage.label(found > 0, structure=faces)[1] <= count
order = np.unique(found[phase], return_index=True)[1]
assert (np.diff(order) > 0).all()
