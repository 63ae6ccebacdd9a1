#!/usr/bin/python3
"""CPU time of a particle and step: `solve` against stock LIGGGHTS on the same packing with the same neighbour skin.

The stock path is `pair_style gran model hooke/stiffness tangential no_history`, with a stiffness so small that the
packing stays as it is: nothing moves, no list is rebuilt, every branch is well predicted. Its full variant has two
moving mesh plates, averaged forces and dumps. Ours is a whole loading run: hot packing, lists, planes, curves, frames.
The bare loop of ours is a free relaxation. Each time is the difference of a long and a short run (set-up left out), user
and system, all processes; runs alternate between ours and stock.

usage: against_stock.py BIN [--particles N] [--runs R] [--processes P] [--laws bilin trilin self-contact]
"""
import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

import h5py

from samples import tiled

ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
LAWS = {  # law, stiffness, period, crown radius, time step, neighbour skin as in the solver, density of the brick
    "bilin": ("bilin", 2.65e9, 2.53, 0.75, 5e-3, 0.3, 0.70),
    "trilin": ("trilin", 1.42e9, 1.0, 0.70, 0.1, 0.8, 0.74),
    "self-contact": ("trilin", 1.42e9, 1.0, 0.70, 0.1, 0.8, 0.74),
}
STOCK = """atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
read_data sample.data
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
fix young all property/global youngsModulus peratomtype 5e6
fix poisson all property/global poissonsRatio peratomtype 0.3
fix kn all property/global kn peratomtypepair 1 1
fix kt all property/global kt peratomtypepair 1 0
fix gamman all property/global gamman peratomtypepair 1 0
fix gammat all property/global gammat peratomtypepair 1 0
fix friction all property/global coefficientFriction peratomtypepair 1 0
pair_style gran model hooke/stiffness tangential no_history
pair_coeff * *
timestep {time_step}
fix integration all nve
thermo 100000
thermo_style custom step atoms
"""
PLATES = """fix top all mesh/surface/stress file plate.stl type 1 move 0 0 {top} reference_point 0 0 {top}
fix bottom all mesh/surface/stress file plate.stl type 1 move 0 0 {bottom} reference_point 0 0 {bottom}
fix plates all wall/gran model hooke/stiffness tangential no_history mesh n_meshes 2 meshes top bottom
fix press_top all move/mesh mesh top linear 0 0 -1e-6
fix press_bottom all move/mesh mesh bottom linear 0 0 1e-6
variable on_top equal f_top[3]
variable on_bottom equal f_bottom[3]
fix curve all ave/time 1 100 100 v_on_top v_on_bottom file curve.txt
dump frames all custom {dump} frame*.txt id x y z
"""


def cpu_of(command, environment):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], env=os.environ | ROOT | environment, capture_output=True)
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} failed: {done.stderr.decode()[-500:]} {done.stdout.decode()[-500:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def write_sample(sample, crown):
    with h5py.File(sample) as file:
        points = file["particles/all/position/value"][0] / file["particles/all"].attrs["seed_radius"] * 0.5
    points -= (points.max(axis=0) + points.min(axis=0)) / 2
    half = points.max(axis=0) + 6
    with open("sample.data", "w") as file:
        file.write(f"sample\n\n{len(points)} atoms\n1 atom types\n\n")
        for axis, name in enumerate("xyz"):
            file.write(f"{-half[axis]:.6f} {half[axis]:.6f} {name}lo {name}hi\n")
        file.write("\nAtoms\n\n")
        for k, (x, y, z) in enumerate(points):
            file.write(f"{k + 1} 1 {2 * crown} 1e7 {x:.9g} {y:.9g} {z:.9g}\n")
    x, y = half[0] - 0.5, half[1] - 0.5
    corners = [(-x, -y), (x, -y), (x, y)], [(-x, -y), (x, y), (-x, y)]
    with open("plate.stl", "w") as file:
        file.write("solid plate\n")
        for triangle in corners:
            file.write("facet normal 0 0 1\nouter loop\n")
            for a, b in triangle:
                file.write(f"vertex {a:.6f} {b:.6f} 0\n")
            file.write("endloop\nendfacet\n")
        file.write("endsolid plate\n")
    return points[:, 2].max() + 0.5


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--particles", type=float, default=5e4)
parser.add_argument("--runs", type=int, default=3)
parser.add_argument("--processes", type=int, default=1)
parser.add_argument("--laws", nargs="+", default=list(LAWS), choices=LAWS)
options = parser.parse_args()
options.bin = options.bin.resolve()
particles = int(options.particles)
mpirun = ["mpirun", "-np", options.processes] if options.processes > 1 else []
short, long = (100, 500) if particles <= 2e5 else (40, 160)

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for name in options.laws:
        law, stiffness, period, crown, time_step, skin, density = LAWS[name]
        rate = 1e-3

        def scene(steps):
            contact = "[contact]\nself_contact = true\n" if name == "self-contact" else ""
            pathlib.Path("scene.toml").write_text(
                f'[phase.a]\nlabel = 1\nlaw = "{law}"\nrepulsive_stiffness = {stiffness}\nnatural_period = {period}\n'
                f"{contact}[load]\nsteps = [ {{ strain = {-rate * time_step * steps}, rate = {rate} }} ]\n"
                f"[accuracy]\ntime_step = {time_step}\naveraging_strain = {100 * rate * time_step}\nframes = 2\n")

        def stock(steps, plates):
            text = STOCK.format(skin=skin, time_step=time_step)
            if plates:
                text += PLATES.format(top=top, bottom=-top, dump=max(1, steps // 2))
            pathlib.Path("stock.in").write_text(text + f"run {steps}\n")
            return cpu_of([*mpirun, "liggghts", "-in", "stock.in", "-log", "none"], {})

        def ours(steps):
            scene(steps)
            return cpu_of([*mpirun, options.bin / "solve", "relaxed.h5", "scene.toml", "run.h5", "--quiet", "--json",
                           "run.json"], {})

        def bare(steps):
            scene(steps)
            return cpu_of([*mpirun, options.bin / "relax", "relaxed.h5", "scene.toml", "free.h5", "--quiet",
                           "--max-periods", steps / 20, "--energy-ratio", "1e-300"], {})

        scene(1000)
        brick = min(particles, 50000)  # larger samples are put together from bricks
        subprocess.run([options.bin / "packgen", "brick.h5", "--particles", str(brick), "--density", str(density),
                        "--quiet"], check=True)
        if particles > brick:
            os.rename("brick.h5", "one.h5")
            tiled("one.h5", particles, "brick.h5")
        subprocess.run([options.bin / "relax", "brick.h5", "scene.toml", "relaxed.h5", "--quiet"], check=True)
        top = write_sample("relaxed.h5", crown)
        times = {"stock, bare": lambda n: stock(n, False), "stock, plates": lambda n: stock(n, True),
                 "ours, bare": bare, "ours, whole": ours}
        found = {key: [] for key in times}
        for _ in range(options.runs):
            for key, run in times.items():
                found[key].append(1e9 * (run(long) - run(short)) / (long - short) / particles)
        print(f"{name}, {particles} particles, {options.processes} process(es), {options.runs} runs: "
              "ns of CPU a particle and step, least and median")
        for key, values in found.items():
            print(f"  {key:14} {min(values):7.1f} {statistics.median(values):7.1f}")
        for mine, theirs in (("ours, bare", "stock, bare"), ("ours, whole", "stock, plates"),
                             ("ours, whole", "stock, bare")):
            ratios = [b / a for a, b in zip(found[mine], found[theirs])]
            print(f"  {theirs} / {mine}: {min(found[theirs]) / min(found[mine]):.1f} (of the least), "
                  f"{statistics.median(ratios):.1f} (median of pairs)")
        memory = json.loads(pathlib.Path("run.json").read_text())["peak_bytes"] / particles
        print(f"  peak memory of ours: {memory:.0f} bytes a particle", flush=True)
