"""adjusted_rand_index(a, b): how far two numberings of the same voxels agree; 1: the same parts, 0: by chance."""
import numpy as np


def adjusted_rand_index(a, b):
    pairs = lambda counts: (counts.astype(float) * (counts - 1) / 2).sum()
    both = pairs(np.unique(a.astype(np.int64) * (int(b.max()) + 1) + b, return_counts=True)[1])
    of_a, of_b = pairs(np.bincount(a)), pairs(np.bincount(b))
    chance = of_a * of_b / pairs(np.array([a.size]))
    return (both - chance) / ((of_a + of_b) / 2 - chance)
