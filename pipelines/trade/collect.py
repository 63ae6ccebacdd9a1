#!/usr/bin/python3
"""Collects what was measured of the runs, and what they cost, into one table: a row for each run and quantity.

usage: collect.py FOLDER TABLE.csv RUN...

A run that did not survive has the quantity "none". Its steps are computations of all pair forces: of quasi-static runs their
evaluations. CPU seconds of `prepare` are those of filling and relaxing or carving.
"""
import csv
import json
import pathlib
import sys

import numpy as np

COLUMNS = ["scene", "law", "size", "step", "rate", "filter", "packing", "quantity", "value", "particles", "steps", "time_step",
           "cpu_solve", "cpu_prepare", "peak_bytes"]


def column(path, name, at):
    """Value of a column at a strain, straight between the frames."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    strain = [float(row["abs_strain [-]"]) for row in rows]
    return float(np.interp(at, strain, [float(row[name] or 0) for row in rows]))


def measured(scene, stem):
    if scene == "single":
        yield "flow_stress", json.loads(stem(".stress.json").read_text())["flow_stress"]
        yield "volume", 1 + column(stem(".volume.csv"), "volume_change [-]", 0.3)
    if scene == "inclusion":
        yield "composite_stress", json.loads(stem(".stress.json").read_text())["flow_stress_engineering"]
        yield "shape_factor", column(stem(".shape.csv"), "shape_factor [-]", 0.3)
    if scene == "pore":
        yield "pore_start", column(stem(".pores.csv"), "volume_corrected [mm^3]", 0)
        yield "pore_pressed", column(stem(".pores.csv"), "volume_corrected [mm^3]", 0.2)
    if scene == "foam":
        yield "foam_stress", json.loads(stem(".stress.json").read_text())["flow_stress"]
        yield "foam_density", json.loads(stem(".solid.json").read_text())["volume_corrected"]


def main(folder, table, *names):
    folder = pathlib.Path(folder)
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for name in names:
            scene, law, size, step, rate, kind, packing = name.split("_")
            row = {"scene": scene, "law": law, "size": size, "step": step, "rate": rate, "filter": kind, "packing": packing}
            stem = lambda end: folder / (name + end)
            if stem(".h5").stat().st_size == 0:
                writer.writerow(row | {"quantity": "none"})
                continue
            run = json.loads(stem(".json").read_text())
            sample = folder / "_".join((scene, law, size, kind, packing))
            summaries = [run] + [json.loads(path.read_text()) for path in
                                 (pathlib.Path(f"{sample}.sample.json"), pathlib.Path(f"{sample}.relaxed.json")) if path.exists()]
            row |= {"particles": run["particles"], "steps": run.get("evaluations", run["steps"]), "time_step": run["time_step"],
                    "cpu_solve": run["cpu_seconds"], "cpu_prepare": sum(one["cpu_seconds"] for one in summaries[1:]),
                    "peak_bytes": max(one["peak_bytes"] for one in summaries)}
            for quantity, value in measured(scene, stem):
                writer.writerow(row | {"quantity": quantity, "value": repr(value)})
        # Of one pore by other probes.
        for path in sorted(folder.glob("*.probe_*.csv")):
            name, probe = path.name.removesuffix(".csv").split(".probe_")
            scene, law, size, step, rate, kind, packing = name.split("_")
            if name in names:
                writer.writerow({"scene": scene, "law": law, "size": size, "step": step, "rate": rate, "filter": f"probe {probe}",
                                 "packing": packing, "quantity": "pore_start", "value": column(path, "volume_corrected [mm^3]", 0)})


main(*sys.argv[1:])
