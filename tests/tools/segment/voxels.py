"""What the tests of these tools share: volumes as arrays [z][y][x], and how far two numberings of voxels agree."""
import numpy as np
from PIL import Image, ImageSequence
from tifffile import imwrite as write


def read(path):
    """A multipage TIFF of any compression."""
    return np.array([np.array(page) for page in ImageSequence.Iterator(Image.open(path))])


def adjusted_rand_index(a, b):
    """1: the same parts; 0: no better than chance (Hubert & Arabie, J. Classification 2 (1985) 193)."""
    a, b = a.astype(np.int64), b.astype(np.int64)

    def pairs(counts):
        return (counts.astype(float) * (counts - 1) / 2).sum()

    both = pairs(np.unique(a * (b.max() + 1) + b, return_counts=True)[1])
    of_a, of_b = pairs(np.bincount(a)), pairs(np.bincount(b))
    chance = of_a * of_b / pairs(np.array([a.size]))
    return (both - chance) / ((of_a + of_b) / 2 - chance)
