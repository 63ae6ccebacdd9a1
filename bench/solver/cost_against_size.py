#!/usr/bin/python3
"""Cost of `solve` against the number of particles: wall time and memory of a particle on one and two processes, and
where the time goes.

A periodic brick is put together as often as the size asks for, so that every sample has the same packing, and pressed
with BILIN: planes, curves and a frame at the begin and the end. Times are differences of a long and a short run of the
same sample, least of the runs, by the solver's own clock. The shares are samples of `perf record` (package linux-perf)
over the whole long run, set-up included; without perf they are left out.

usage: cost_against_size.py BIN [--sizes 1e4 ...] [--runs R] [--law bilin|trilin|self-contact]
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from samples import tiled

ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
BRICK = 1e4
LAWS = {  # law, stiffness, period, time step, density
    "bilin": ("bilin", 2.65e9, 2.53, 5e-3, 0.70),
    "trilin": ("trilin", 1.42e9, 1.0, 0.1, 0.74),
    "self-contact": ("trilin", 1.42e9, 1.0, 0.1, 0.74),
}
RATE = 1e-3
SHARES = [  # what, symbols of it
    ("pair loop", r"VectorPairs::compute|scalar_pairs"),
    ("search for pairs, listing", r"PairSearch|PairList|list_pairs|add_blocks"),
    ("integration", r"::integrate|FixIntegrate|VectorPairs::(add_forces|copy|bring)"),
    ("LIGGGHTS' builds, exchange", r"FixRebuild|Neighbor::|Comm::(exchange|borders)|AtomVec|Irregular|Domain|Atom::sort"),
    ("communication", r"forward_comm|pack_comm|PMPI|opal_|mca_|ompi_|pack_(vel|comm)|vader|btl"),
    ("planes", r"FixPlanes|press"),
    ("energies, frames, checkpoints", r"seed_energy|Simulation::|H5|write|checkpoint"),
]


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--sizes", type=float, nargs="+", default=[1e4, 5e4, 2e5, 1e6, 3e6])
parser.add_argument("--runs", type=int, default=2)
parser.add_argument("--law", choices=LAWS, default="bilin")
options = parser.parse_args()
tools = options.bin.resolve()
law, stiffness, period, time_step, density = LAWS[options.law]

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([tools / "packgen", "brick.h5", "--particles", str(int(BRICK)), "--density", str(density), "--quiet"],
                   check=True)

    def run(processes, steps, tool=()):
        contact = "[contact]\nself_contact = true\n" if options.law == "self-contact" else ""
        pathlib.Path("scene.toml").write_text(
            f'[phase.a]\nlabel = 1\nlaw = "{law}"\nrepulsive_stiffness = {stiffness}\nnatural_period = {period}\n'
            f"{contact}[load]\nsteps = [ {{ strain = {-RATE * time_step * steps}, rate = {RATE} }} ]\n"
            f"[accuracy]\ntime_step = {time_step}\naveraging_strain = {100 * RATE * time_step}\nframes = 2\n")
        mpirun = ["mpirun", "-np", str(processes), "--bind-to", "core"] if processes > 1 else []
        command = [*mpirun, *tool, tools / "solve", "sample.h5", "scene.toml", "run.h5", "--quiet", "--json", "run.json"]
        done = subprocess.run([str(word) for word in command], env=os.environ | ROOT, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"solve failed: {done.stderr[-500:]}")
        return json.loads(pathlib.Path("run.json").read_text())

    print(f"{options.law}; ns of wall time a particle and step on 1 and 2 processes, their efficiency, bytes a particle")
    for size in options.sizes:
        count = tiled("brick.h5", size, "sample.h5")
        long = int(min(3000, max(60, 4e7 / count)))
        short = long // 5
        wall, memory = {}, {}
        for processes in (1, 2):
            spent = []
            for _ in range(options.runs):
                ends = [run(processes, steps) for steps in (short, long)]
                spent.append(ends[1]["wall_seconds"] - ends[0]["wall_seconds"])
                memory[processes] = ends[1]["peak_bytes"] / count
            wall[processes] = 1e9 * min(spent) / (long - short) / count
        print(f"{count:9d}  {wall[1]:6.1f} {wall[2]:6.1f}  {wall[1] / wall[2] / 2:5.0%}  {memory[1]:6.0f} {memory[2]:6.0f}",
              flush=True)
        if shutil.which("perf"):
            run(1, long, ["perf", "record", "-q", "-o", "perf.data"])
            report = subprocess.run(["perf", "report", "-i", "perf.data", "--stdio", "-F", "overhead,symbol", "-w", "9,400"],
                                    capture_output=True, text=True).stdout
            shares = dict.fromkeys([name for name, _ in SHARES] + ["other"], 0.0)
            for line in report.splitlines():
                found = re.match(r"\s*([\d.]+)%\s+(.*)", line)
                if found:
                    name = next((name for name, symbols in SHARES if re.search(symbols, found[2])), "other")
                    shares[name] += float(found[1])
            print("           " + ", ".join(f"{name} {share:.0f} %" for name, share in shares.items()), flush=True)
