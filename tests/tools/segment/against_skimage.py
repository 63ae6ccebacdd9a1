#!/usr/bin/python3
"""Compares the objects of separate_objects with scikit-image's watershed of the same phase.

usage: against_skimage.py IMAGE.tif LABEL OBJECTS.tif FIRST MIN_DEPTH_VOXELS

Both take the distance map, its h-maxima as seeds, and neighbours that share a face. The floods differ where two seeds are
equally near; so the objects are as many, each voxel's object is compared, and the adjusted Rand index.
"""
import sys

import numpy as np
from scipy import ndimage
from skimage.morphology import local_maxima, reconstruction
from skimage.segmentation import watershed
from tifffile import imread

from rand_index import adjusted_rand_index

image, label, objects, first, depth = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4]), float(sys.argv[5])
phase = imread(image) == label
found = np.where(phase, imread(objects).astype(np.int64) - first + 1, 0)
assert found[phase].min() == 1

faces = ndimage.generate_binary_structure(3, 1)
distance = np.where(phase, ndimage.distance_transform_edt(phase), -1e4).astype(np.float32)
deep = reconstruction(distance - np.float32(depth), distance, footprint=faces)
seeds, count = ndimage.label(local_maxima(deep, connectivity=1) & phase, structure=faces)
expected = watershed(-distance, seeds, mask=phase)

index = adjusted_rand_index(found[phase], expected[phase])
print(f"objects: {found.max()}, scikit-image {count}; adjusted Rand index {index:.4f}")
assert found.max() == count
assert len(np.unique(found[phase])) == count
assert index > 0.98
# Every object is one piece, from 1 on in the order of first voxels.
assert ndimage.label(found > 0, structure=faces)[1] <= count
order = np.unique(found[phase], return_index=True)[1]
assert (np.diff(order) > 0).all()
