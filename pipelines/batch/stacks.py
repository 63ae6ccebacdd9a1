#!/usr/bin/python3
"""Lists the stacks of a folder as NAME=VOLUME words. usage: stacks.py FOLDER BIN"""
import pathlib
import re
import subprocess
import sys


def stacks_of(folder, tools):
    """Name -> path of each volume that volume_info finds, and path -> reason of what cannot be worked on."""
    listed = subprocess.run([tools / "volume_info", folder, "--find"], stdout=subprocess.PIPE, text=True)
    if listed.returncode != 0:
        sys.exit(1)
    found, refused = {}, {}
    for path in map(pathlib.Path, listed.stdout.splitlines()):
        name = path.name if path.is_dir() else path.stem
        if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*", name):
            refused[path] = "make cannot work with this name; use letters, digits and . _ + -"
        elif name in found:
            refused[path] = f"'{found[name].name}' has the same name; rename one of them"
        else:
            found[name] = path
    return found, refused


def main():
    folder, tools = map(pathlib.Path, sys.argv[1:])
    if not folder.is_dir():
        sys.exit(f"stacks: there is no folder '{folder}'; give the one with the stacks as STACKS=")
    found, refused = stacks_of(folder, tools)
    if not found and not refused:
        sys.exit(f"stacks: '{folder}' has no stack: no file of a volume (docs/volumes.md) and no folder of TIFF slices")
    print(*(f"{name}={path}" for name, path in found.items()))


if __name__ == "__main__":
    main()
