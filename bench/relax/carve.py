#!/usr/bin/python3
"""Pores of a sample beside those of its image: carve, and masking once as the thesis did.

Cases: "phantom", a casting with 20 pores, 10 to 35 particles across (720,000 particles); "iron", a part of a real
tomography, nodular cast iron, with its graphite nodules read as pores (needs the data set's folder); "small", a phantom of
6 pores for a quick look. Prints for both ways the error of the total volume, of the worst pore above 12 particles across
(both by alpha shape), of the total by the grid and, for carve with closed pores alone, by the mass that is missing (as if the
sample's faces stayed where those of the dense sample at rest are), and the intersection over union with the
image's pores.

usage: carve.py BIN [--case phantom|iron|small ...] [--iron FOLDER] [--law bilin|trilin|norton ...] [--json FILE] [--keep FOLDER]
"""
import argparse
import contextlib
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import time

import h5py
import numpy as np

LAWS = {  # phase, density of the brick
    "bilin": ('law = "bilin"\nnorton = { K = 95.9, M = 2.45e-3 }\n', 0.65),
    "trilin": ('law = "trilin"\nnorton = { K = 49.1, M = 0.0714 }\n', 0.74),
    "norton": ('law = "norton"\nnorton = { K = 5020, M = 0.49 }\n', 0.64),
}
PHANTOMS = {  # options of phantom_pores, pixels per seed
    "phantom": ("--size 300 --voxel-size 10um --porosity 0.18 --median-diameter 640um --spread 0.42 --clusters 0.2 --gap 12 "
                "--random-seed 7", 1.8),
    "small": ("--size 120 --voxel-size 10um --porosity 0.1 --median-diameter 400um --spread 0.2 --clusters 0.2 --gap 8 "
              "--random-seed 6", 1.5),
}
IRON_VOXELS = ["--voxel-size", "3um", "--roi", "0:160,0:160,0:160"]

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--case", nargs="+", default=["phantom"], choices=["phantom", "iron", "small"])
parser.add_argument("--iron", type=pathlib.Path, help="folder of the label slices of the cast iron")
parser.add_argument("--law", nargs="+", default=["bilin"], choices=list(LAWS))
parser.add_argument("--json", type=pathlib.Path)
parser.add_argument("--keep", type=pathlib.Path, help="work here and leave everything")
options = parser.parse_args()
tools = options.bin.resolve()
json_file = options.json.resolve() if options.json else None
iron = options.iron.resolve() if options.iron else None


def call(tool, *arguments, check=True):
    """@return what it wrote on stderr, and its time"""
    begun = time.monotonic()
    done = subprocess.run([tools / tool, *map(str, arguments)], text=True, stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE)
    if check and done.returncode != 0:
        raise SystemExit(done.stderr)
    return done.stderr, time.monotonic() - begun


def count(name):
    with h5py.File(name) as file:
        return file["particles/all/id"].shape[0], file["particles/all"].attrs["seed_radius"]


def figures(name, table, dense, density, target, seconds):
    """The last row of a table of iterations, and the volume of the particles that are missing."""
    row = list(csv.DictReader(open(table)))[-1]
    particles, seed_radius = count(name)
    missing = (dense - particles) * 4 / 3 * np.pi * seed_radius**3 / density
    return {"particles": particles, "total": float(row["total_error [-]"]), "grid": float(row["grid_error [-]"]),
            "mass": missing / target - 1, "worst": float(row["worst_error [-]"]), "iou": float(row["iou [-]"]),
            "judged": int(row["judged"]), "iterations": int(row["iteration"]), "minutes": seconds / 60}


results = {}
with contextlib.ExitStack() as stack:
    folder = options.keep or stack.enter_context(tempfile.TemporaryDirectory())
    pathlib.Path(folder).mkdir(exist_ok=True)
    os.chdir(folder)
    for law in options.law:
        phase, density = LAWS[law]
        pathlib.Path("scene.toml").write_text(
            f"[phase.a]\nlabel = 1\n{phase}[load]\nsteps = [ {{ strain = -0.3, rate = 1e-3 }} ]\n")
        call("packgen", "brick.h5", "--particles", 20000, "--density", density)
        for case in options.case:
            if case == "iron":
                if iron is None:
                    raise SystemExit("carve.py: give --iron FOLDER for the case 'iron'")
                image, voxels, pixels = iron, IRON_VOXELS, 1.2
                filled, masked = ["--relabel", "2=1"], ["--relabel", "1=0,2=1"]
            else:
                request, pixels = PHANTOMS[case]
                call("phantom_pores", "image.tif", *request.split())
                image, voxels = "image.tif", ["--voxel-size", "10um"]
                filled, masked = ["--relabel", "0=1"], []
            for name, labels in (("dense", filled), ("masked", masked)):
                call("vol2pack", "brick.h5", image, f"{name}.h5", *voxels, *labels, "--pixels-per-seed", pixels)
            _, seconds = call("carve", "dense.h5", "scene.toml", image, "carved.h5", *voxels, *masked, "--json", "carved.json",
                              "--pores", "pores.csv")
            summary = json.loads(pathlib.Path("carved.json").read_text())
            dense, _ = count("dense.h5")
            given = dense, summary["density"], summary["image_volume"]
            _, once_seconds = call("relax", "masked.h5", "scene.toml", "once.h5")
            call("carve", "once.h5", "scene.toml", image, "measured.h5", *voxels, *masked, "--max-iterations", 0, "--table",
                 "once.csv", check=False)
            found = {"carve": figures("carved.h5", "carved.csv", *given, seconds),
                     "once": figures("once.h5", "once.csv", *given, once_seconds)}
            results[f"{case}, {law}"] = found | {kind: summary[kind] for kind in ("closed_pores", "cut_pores", "open_pores")}
            print(f"{case}, {law}: {dense} particles, {summary['closed_pores']} closed pores and {summary['cut_pores']} cut ones, "
                  f"of which {summary['judged_pores']} judged; {summary['open_pores']} open, {summary['too_small_pores']} too small")
            for way, f in found.items():
                mass = "" if summary["open_pores"] or summary["cut_pores"] or way == "once" else f", {f['mass']:+.2%} by mass"
                print(f"  {way:5}: total {f['total']:+.2%} ({f['grid']:+.2%} by grid{mass}), worst pore {f['worst']:+.2%}, IoU "
                      f"{f['iou']:.3f}, {f['iterations']} iterations, {f['minutes']:.1f} min", flush=True)
if json_file:
    json_file.write_text(json.dumps(results, indent=1) + "\n")
