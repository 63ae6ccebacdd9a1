#!/usr/bin/python3
"""Lists the stacks of a folder as NAME=VOLUME words. usage: stacks.py FOLDER"""
import pathlib
import re
import sys

SLICES = (".tif", ".tiff")
IMAGES = (*SLICES, ".mha", ".mhd", ".nrrd", ".nhdr", ".vdb", ".h5", ".hdf5", ".vol", ".raw")
HEADERS = (".mhd", ".nhdr")


def is_stack(path):
    if path.is_dir():
        return any(one.suffix.lower() in SLICES for one in path.iterdir())
    if path.suffix == ".raw" and any(path.with_suffix(header).exists() for header in HEADERS):
        return False  # the voxels of the stack that the header is
    return path.suffix.lower() in IMAGES


def stacks_of(folder):
    """Name -> path of each stack, and path -> reason of what cannot be worked on."""
    found, refused = {}, {}
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or not is_stack(path):
            continue
        name = path.name if path.is_dir() else path.stem
        if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*", name):
            refused[path] = "make cannot work with this name; use letters, digits and . _ + -"
        elif name in found:
            refused[path] = f"'{found[name].name}' has the same name; rename one of them"
        else:
            found[name] = path
    return found, refused


def main():
    folder = pathlib.Path(sys.argv[1])
    if not folder.is_dir():
        sys.exit(f"stacks: there is no folder '{folder}'; give the one with the stacks as STACKS=")
    found, refused = stacks_of(folder)
    if not found and not refused:
        sys.exit(f"stacks: '{folder}' has no stack: {', '.join(IMAGES)} or folders of TIFF slices")
    print(*(f"{name}={path}" for name, path in found.items()))


if __name__ == "__main__":
    main()
