#!/usr/bin/python3
"""Prints a scene with some of its values changed; everything else, comments too, stays as it is.

usage: vary.py SCENE.toml TABLE.KEY=VALUE...        as accuracy.strain_per_step=1e-5 phase.a.law='"norton"' seed_radius=0.4
"""
import sys

import tomlkit
from tomlkit.exceptions import ParseError


def change(scene, name, value):
    *tables, key = name.split(".")
    table = scene
    for one in tables:
        table = table.setdefault(one, tomlkit.table())
    table[key] = tomlkit.value(value)


def main(path, *changes):
    with open(path) as file:
        scene = tomlkit.parse(file.read())
    for one in changes:
        name, separator, value = one.partition("=")
        if not separator:
            sys.exit(f"vary: '{one}' is not TABLE.KEY=VALUE")
        try:
            change(scene, name.strip(), value.strip())
        except ParseError as error:
            sys.exit(f"vary: {path} with {one} is no TOML: {error}")
    print(tomlkit.dumps(scene), end="")


main(*sys.argv[1:])
