#!/usr/bin/python3
"""Measures pictures of render; exits with an error when a claim does not hold.

usage: check_picture.py size PNG WIDTH HEIGHT
       check_picture.py orange_share PNG LOW HIGH   share of orange among the pixels of particles
       check_picture.py empty_share PNG LOW HIGH    share of pixels that show the white background
       check_picture.py dark_share PNG LOW HIGH     share of the drawing that is dark in the mean over 12 x 12 pixels
       check_picture.py same_scale PNG PNG          both have the same scale bar
       check_picture.py share PNG R,G,B LOW HIGH    share of pixels of this hue, light or dark, in the drawing
       check_picture.py bar PNG COLOURS             at least so many colours side by side in the upper right: a colour bar
       check_picture.py no_bar PNG                  no such thing
       check_picture.py left_right PNG              what is dark at the left of the drawing is so at the right, mirrored
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


def hue_share(path, colour):
    """Pixels whose red, green and blue are as a multiple of the colour's."""
    image, wanted = drawing(path).astype(float), np.array([float(part) for part in colour.split(",")])
    length = np.linalg.norm(image, axis=2) * np.linalg.norm(wanted)
    return np.mean((image @ wanted > 0.985 * length) & (length > 0))


def colours_of_bar(path):
    """The most colours that one line of pixels has in the upper right."""
    image = pixels(path)
    corner = image[: len(image) // 9, image.shape[1] * 6 // 10 :]
    coloured = [line[line.max(axis=1) - line.min(axis=1) > 20] for line in corner]
    return max(len(np.unique(line, axis=0)) for line in coloured)


what, first, *rest = sys.argv[1:]
if what == "size":
    height, width = pixels(first).shape[:2]
    if [str(width), str(height)] != rest:
        sys.exit(f"{first} has {width} x {height} pixels, expected {' x '.join(rest)}")
elif what == "orange_share":
    between("share of orange", shares(first)[0], *rest)
elif what == "empty_share":
    between("share of background", shares(first)[1], *rest)
elif what == "dark_share":
    grey = drawing(first).max(axis=2)
    height, width = (size // 12 for size in grey.shape)
    blocks = grey[: 12 * height, : 12 * width].reshape(height, 12, width, 12).mean(axis=(1, 3))
    between("share of dark places", np.mean(blocks < 110), *rest)
elif what == "same_scale":
    height, width = pixels(first).shape[:2]
    bar = [pixels(path)[int(0.9 * height) :, : width // 2] for path in (first, rest[0])]
    if not np.array_equal(*bar):
        sys.exit("the scale bars differ")
elif what == "share":
    between(f"share of {rest[0]}", hue_share(first, rest[0]), *rest[1:])
elif what == "bar":
    if colours_of_bar(first) < int(rest[0]):
        sys.exit(f"{first} has {colours_of_bar(first)} colours in its upper right, expected a bar of {rest[0]} or more")
elif what == "no_bar":
    if colours_of_bar(first) > 4:
        sys.exit(f"{first} has a colour bar")
elif what == "left_right":
    dark = drawing(first).max(axis=2) < 60
    left, right = dark[:, : dark.shape[1] // 4], dark[:, -(dark.shape[1] // 4) :]
    if left.sum() < 40 or abs(left.sum() - right.sum()) > 0.3 * left.sum():
        sys.exit(f"{first} has {left.sum()} dark pixels at its left and {right.sum()} at its right")
else:
    sys.exit(__doc__)
