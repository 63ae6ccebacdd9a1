#!/usr/bin/python3
"""What packings cost and how random they are, against the size, and against another generator in the same run.

usage: random_packing.py BIN [--particles N,N...] [--densities D,D...] [--threads T] [--reference PROGRAM] [--plot G.png]

BIN is the folder of packgen. PROGRAM is an executable of packing-generation (V. Baranau, github.com/VasiliBaranov, MIT
licence), which must be built apart from this project: its force-biased algorithm packs hard spheres, serially, to the
density that its contraction rate allows. CPU seconds are compared, as packgen is threaded and machines are busy.
"""
import argparse
import json
import math
import os
import re
import resource
import subprocess
import tempfile
import time


def measured(command, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - start, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def packed(program, particles, density, threads, folder):
    wall, cpu = measured([program, "brick.h5", "--particles", str(particles), "--density", str(density), "--threads",
                          str(threads), "--no-cache", "--quiet", "--json", "brick.json"], folder)
    with open(os.path.join(folder, "brick.json")) as file:
        return wall, cpu, json.load(file)


def force_biased(program, particles, rate, folder):
    """Density, CPU seconds of the algorithm (its own clock: without the search of the closest pair that ends it)."""
    edge = (math.pi / 6 * particles / 0.65) ** (1 / 3)
    with open(os.path.join(folder, "generation.conf"), "w") as file:
        file.write(f"Particles count: {particles}\nPacking size: {edge} {edge} {edge}\nGeneration start: 1\nSeed: 341\n"
                   f"Steps to write: 1000000\nBoundaries mode: 1\nContraction rate: {rate}\n")
    _, cpu = measured([program, "-fba"], folder)
    with open(os.path.join(folder, "packing.nfo")) as file:
        text = file.read()
    seconds = float(re.search(r"Total Simulation Time: (\S+)", text).group(1))
    return 1 - float(re.search(r"Final Porosity: (\S+)", text).group(1)), min(cpu, seconds)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("bin")
    parser.add_argument("--particles", default="5000,20000")
    parser.add_argument("--densities", default="0.55,0.64,0.65,0.70,0.76")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--reference")
    parser.add_argument("--plot")
    options = parser.parse_args()
    program = os.path.join(os.path.abspath(options.bin), "packgen")
    curves = {}
    print(f"{'particles':>9} {'D':>5} {'steps':>6} {'wall s':>8} {'CPU s':>8} {'peak MB':>8} {'ns/part/step':>12} {'Z':>6} "
          f"{'rattlers':>8} {'cryst.':>8} {'solid':>8} {'q6':>6} {'Q6':>7}")
    for particles in (int(float(word)) for word in options.particles.split(",")):
        for density in (float(word) for word in options.densities.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                wall, cpu, r = packed(program, particles, density, options.threads, folder)
            print(f"{particles:9d} {density:5.2f} {r['steps']:6.0f} {wall:8.1f} {cpu:8.1f} {r['peak_bytes'] / 1e6:8.0f} "
                  f"{cpu / particles / r['steps'] * 1e9:12.0f} {r['backbone_coordination']:6.2f} {r['rattlers']:8.4f} "
                  f"{r['crystalline']:8.4f} {r['solid_like']:8.4f} {r['mean_q6']:6.3f} {r['global_q6']:7.4f}", flush=True)
            curves[particles, density] = r["radial_distribution"]
    if options.reference:
        reference = os.path.abspath(options.reference)
        print(f"\n{'particles':>9} {'force-biased: rate':>18} {'D':>6} {'CPU s':>8} | {'packgen CPU s':>13} {'ratio':>6}")
        for particles in (10000,):
            for rate in (1e-3, 1e-4):
                with tempfile.TemporaryDirectory() as folder:
                    density, cpu = force_biased(reference, particles, rate, folder)
                    _, own, _ = packed(program, particles, round(density, 4), 1, folder)
                print(f"{particles:9d} {rate:18g} {density:6.4f} {cpu:8.1f} | {own:13.1f} {cpu / own:6.1f}", flush=True)
    if options.plot:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        largest = max(particles for particles, _ in curves)
        figure, axes = plt.subplots(figsize=(7, 4))
        for (particles, density), curve in curves.items():
            if particles == largest:
                axes.plot(curve["r"], curve["g"], label=f"D = {density:g}", linewidth=1)
        for distance, name in ((math.sqrt(2), "√2"), (math.sqrt(3), "√3"), (2, "2")):
            axes.axvline(distance, color="0.8", linewidth=0.8, zorder=0)
            axes.annotate(name, (distance, 3.7), ha="center")
        axes.set(xlim=(0.8, 4), ylim=(0, 4), xlabel="r / d", ylabel="g(r)", title=f"{largest} spheres")
        axes.legend()
        figure.savefig(options.plot, dpi=150, bbox_inches="tight")


main()
