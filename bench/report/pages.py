#!/usr/bin/python3
"""pages.py BIN RUN...: what the page of each run costs and how large it is.

Prints for each run the time and CPU time of `report`, those of `topology` on the same run as a reference beside it and the
ratio of the CPU times, the largest memory of one step, and the size of the page.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

programs = Path(sys.argv[1])
print("run, frames, time [s], CPU time [s], topology CPU time [s], ratio, memory [MB], page [MB]")
for run in map(Path, sys.argv[2:]):
    with tempfile.TemporaryDirectory() as folder:
        summary = {}
        for tool, output in (("report", "page.html"), ("topology", "table.csv")):
            path = Path(folder) / f"{tool}.json"
            subprocess.run([programs / tool, run, Path(folder) / output, "--quiet", "--json", path], check=True)
            summary[tool] = json.loads(path.read_text())
    page, topology = summary["report"], summary["topology"]
    print(f"{run.name}, {page['frames']}, {page['wall_seconds']:.0f}, {page['cpu_seconds']:.0f}, {topology['cpu_seconds']:.1f}, "
          f"{page['cpu_seconds'] / topology['cpu_seconds']:.0f}, {page['peak_bytes'] / 1e6:.0f}, {page['size']:.1f}", flush=True)
