#!/usr/bin/python3
"""Prints what the tools of a folder say of themselves, as words for make: measure/NAME for each measure of a run, threads/NAME
for each tool that takes --threads.

usage: described.py BIN
"""
import json
import pathlib
import sys

try:
    tools = json.loads((pathlib.Path(sys.argv[1]) / "tools.json").read_text())
except (OSError, ValueError) as error:
    sys.exit(f"described: cannot read the list of the tools, which the build makes beside them: {error}")
print(*(f"measure/{tool['name']}" for tool in tools if tool["display"]), *(f"threads/{tool['name']}" for tool in tools if tool["threads"]))
