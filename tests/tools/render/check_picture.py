#!/usr/bin/python3
"""Measures pictures of render; exits with an error when a claim does not hold.

usage: check_picture.py size PNG WIDTH HEIGHT
       check_picture.py orange_share PNG LOW HIGH   share of orange among the pixels of particles
       check_picture.py empty_share PNG LOW HIGH    share of pixels that show the white background
       check_picture.py same_scale PNG PNG          both have the same scale bar
"""
import sys

import matplotlib.image
import numpy as np


def pixels(path):
    return (matplotlib.image.imread(path)[:, :, :3] * 255).round().astype(int)


def drawing(path):
    """The part of a picture between the legend at its top and the scale bar at its bottom."""
    image = pixels(path)
    height = len(image)
    return image[height // 10 : height * 85 // 100]


def shares(path):
    red, green, blue = np.moveaxis(drawing(path), 2, 0)
    orange = red > 2 * blue + 30
    grey = (abs(red - blue) < 25) & (red < 235)
    blue_ones = blue > red + 30
    empty = np.minimum(np.minimum(red, green), blue) == 255
    return orange.sum() / max(1, (orange | grey | blue_ones).sum()), empty.mean()


def between(what, value, low, high):
    if not float(low) <= value <= float(high):
        sys.exit(f"{what} is {value:.4f}, expected {low} to {high}")


what, first, *rest = sys.argv[1:]
if what == "size":
    height, width = pixels(first).shape[:2]
    if [str(width), str(height)] != rest:
        sys.exit(f"{first} has {width} x {height} pixels, expected {' x '.join(rest)}")
elif what == "orange_share":
    between("share of orange", shares(first)[0], *rest)
elif what == "empty_share":
    between("share of background", shares(first)[1], *rest)
elif what == "same_scale":
    height, width = pixels(first).shape[:2]
    bar = [pixels(path)[int(0.9 * height) :, : width // 2] for path in (first, rest[0])]
    if not np.array_equal(*bar):
        sys.exit("the scale bars differ")
else:
    sys.exit(__doc__)
