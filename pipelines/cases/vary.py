#!/usr/bin/python3
"""Prints a scene with some of its values changed; everything else, comments too, stays as it is.

usage: vary.py SCENE.toml TABLE.KEY=VALUE...        as accuracy.strain_per_step=1e-5 phase.a.law='"norton"' seed_radius=0.4
"""
import re
import sys
import tomllib


def changed(text, name, value):
    table, _, key = name.rpartition(".")
    lines = text.splitlines()
    header = f"[{table}]"
    if table and header not in (line.split("#")[0].strip() for line in lines):
        lines += ["", header]
    start = 0 if not table else next(i for i, line in enumerate(lines) if line.split("#")[0].strip() == header) + 1
    end = next((i for i in range(start, len(lines)) if lines[i].lstrip().startswith("[")), len(lines))
    for i in range(start, end):
        if re.match(rf"\s*{re.escape(key)}\s*=", lines[i]):
            lines[i] = f"{key} = {value}"
            break
    else:
        lines.insert(start, f"{key} = {value}")
    return "\n".join(lines) + "\n"


def main(path, *changes):
    with open(path) as file:
        text = file.read()
    for change in changes:
        name, separator, value = change.partition("=")
        if not separator:
            sys.exit(f"vary: '{change}' is not TABLE.KEY=VALUE")
        text = changed(text, name.strip(), value.strip())
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        sys.exit(f"vary: {path} with {' '.join(changes)} is no TOML: {error}")
    print(text, end="")


main(*sys.argv[1:])
