#!/usr/bin/python3
"""S_f of a pressed spherical inclusion against the particles that it is made of: the thesis' figure 12.9.

A ball of phase B (a fifth of the volume) in the middle of a cube of phase A is pressed to a true strain of -0.3 at
1e-3 /s, several packings of each size; the reference is the mean of the largest.

usage: inclusion.py BIN [--out FOLDER] [--most PARTICLES] [--packings N] [--processes N]
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

SCENE = """seed_radius = 0.5
[phase.matrix]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[phase.inclusion]
label = 2
law = "bilin"
norton = { K = 5020, M = 0.49 }
objects = true
[load]
axis = "z"
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]
strain_per_step = 2e-5
frames = 3
"""
PARTICLES = (20, 100, 200, 500, 1000, 2000, 5000, 20000)
VOXELS, SHARE, DENSITY = 120, 0.2, 0.65

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path, help="folder of the executables")
parser.add_argument("--out", type=pathlib.Path, help="folder of inclusion.csv [BIN/../bench]")
parser.add_argument("--most", type=int, default=20000, help="largest number of particles in the inclusion")
parser.add_argument("--packings", type=int, default=5)
parser.add_argument("--processes", default="2")
options = parser.parse_args()
tools = options.bin.resolve()
out = (options.out or options.bin / "../bench").resolve()
out.mkdir(parents=True, exist_ok=True)
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def run(*words):
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def pressed(particles, seed):
    """Particles of the inclusion, S_f at the start and at the end."""
    # A particle stands for the volume of its sphere over the density.
    pixels = VOXELS * (SHARE * DENSITY / (4 / 3 * np.pi) / particles) ** (1 / 3)
    run(tools / "vol2pack", "brick.h5", "ball.raw", "sample.h5", "--raw-size", VOXELS, "--raw-type", "uint8",
        "--voxel-size", "1um", "--pixels-per-seed", pixels, "--objects", 2, "--random-seed", seed, "--quiet")
    run(tools / "relax", "sample.h5", "scene.toml", "relaxed.h5", "--quiet")
    run("mpirun", "-np", options.processes, "--oversubscribe", "--bind-to", "none", tools / "solve", "relaxed.h5",
        "scene.toml", "run.h5", "--quiet")
    run(tools / "object_shapes", "run.h5", "shapes.csv", "--min-particles", 4, "--json", "shapes.json", "--quiet")
    shapes = json.load(open("shapes.json"))["shapes"]
    return shapes[0]["particles"], shapes[0]["shape_factor"], shapes[-1]["shape_factor"]


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    pathlib.Path("scene.toml").write_text(SCENE)
    place = np.indices((VOXELS,) * 3) + 0.5 - VOXELS / 2
    radius = VOXELS * (SHARE * 3 / (4 * np.pi)) ** (1 / 3)
    np.where((place**2).sum(axis=0) < radius**2, 2, 1).astype("u1").tofile("ball.raw")
    run(tools / "packgen", "brick.h5", "--particles", 5000, "--density", DENSITY, "--quiet")
    results = {}
    for particles in PARTICLES:
        if particles <= options.most:
            packings = 2 if particles == min(options.most, max(PARTICLES)) else options.packings
            results[particles] = np.array([pressed(particles, seed) for seed in range(1, packings + 1)])
            count, first, last = results[particles].T
            print(f"{count.mean():8.0f} particles  S_f {first.mean():.4f} +- {first.std():.4f} -> {last.mean():.4f} "
                  f"+- {last.std():.4f}", flush=True)
reference = results[max(results)][:, 2].mean()
print(f"\nerror against {reference:.4f} [%]")
lines = ["particles,error_mean [%],error_deviation [%],error_root_mean_square [%]"]
for particles, of_size in results.items():
    error = 100 * (of_size[:, 2] / reference - 1)
    lines.append(f"{of_size[:, 0].mean():.0f},{error.mean():.3f},{error.std():.3f},{np.sqrt((error**2).mean()):.3f}")
    print(f"{of_size[:, 0].mean():8.0f}  mean {error.mean():+6.2f}  deviation {error.std():5.2f}  root mean square "
          f"{np.sqrt((error**2).mean()):5.2f}")
(out / "inclusion.csv").write_text("\n".join(lines) + "\n")
