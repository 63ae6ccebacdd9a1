#!/usr/bin/python3
"""Time and memory of vol2pack, phase by phase, for about 5 million particles from a brick of 20,000.

A phantom of 640^3 voxels with 300 inclusions at 2 voxels per seed radius. The reference of the same run: a copy of the
sample's bytes to the same disk, synchronised.

usage: speed.py BUILD [--size VOXELS] [--runs R]
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build", type=pathlib.Path)
parser.add_argument("--size", type=int, default=640)
parser.add_argument("--runs", type=int, default=2)
options = parser.parse_args()
tools = options.build.resolve() / "bin"

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([tools / "packgen", "brick.h5", "--particles", "20000", "--density", "0.70", "--quiet"], check=True)
    subprocess.run([tools / "phantom_inclusions", "image.tif", "--size", str(options.size), "--voxel-size", "1um",
                    "--fraction", "0.2", "--count", "300", "--gap", "3", "--quiet"], check=True)
    print(f"load {os.getloadavg()[0]:.1f}; wall seconds, smallest of {options.runs} runs; CPU seconds and memory of all")
    for words in (["--filter", "nearest"], ["--filter", "box"], ["--filter", "level-set"],
                  ["--filter", "level-set", "--skip-components"]):
        best = None
        for _ in range(options.runs):
            start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([tools / "vol2pack", "brick.h5", "image.tif", "sample.h5", "--voxel-size", "1um",
                            "--pixels-per-seed", "2", "--random-seed", "1", *words, "--quiet", "--json", "out.json"],
                           check=True)
            wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            report = json.loads(pathlib.Path("out.json").read_text())
            if best is None or wall < best[0]:
                best = wall, cpu, report
        start = time.monotonic()
        with open("copy.h5", "wb") as copy:
            copy.write(pathlib.Path("sample.h5").read_bytes())
            os.fsync(copy.fileno())
        reference = time.monotonic() - start
        wall, cpu, report = best
        phases = ", ".join(f"{name} {seconds:.2f}" for name, seconds in report["seconds"].items() if seconds > 0.005)
        print(f"{' '.join(words)}: {report['particles']} particles, {wall:.1f} s ({cpu:.1f} s of CPU): {phases}; "
              f"{wall / reference:.1f} copies of the sample; peak so far {after.ru_maxrss / 1e6:.2f} GB")
