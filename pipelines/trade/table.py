#!/usr/bin/python3
"""Writes the table that `plan` uses (tools/plan/trade.toml is one).

usage: table.py REFERENCE.toml RESULTS.csv TABLE.toml [--law LAW DENSITY STEP]... --middle SCENE=SIZE... [--name NAME]
"""
import argparse
import math
import pathlib
import statistics

import numpy as np

from trade import BASE_FILTER, QUANTITIES, Results, setting_error


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return "an unknown processor"


def numbers(values):
    return "[" + ", ".join(f"{value:.4g}" for value in values) + "]"


def straight(x, y):
    """Intercept and slope of least squares."""
    return (statistics.mean(y), 0.0) if len(set(x)) < 2 else tuple(reversed(np.polyfit(x, y, 1)))


def changes_of_steps(results, parts, law, middle, survived):
    """What each step changes against the finest one, of the same packings: the greatest of what was measured."""
    finest = min(survived, key=float)
    changes = []
    for step in survived:
        of_parts = []
        for part in parts:
            by_packing = [{row["packing"]: row["value"] for row in results.of(
                quantity=part, law=law, size=middle, step=one, rate=1.0, filter=BASE_FILTER)} for one in (step, finest)]
            both = by_packing[0].keys() & by_packing[1].keys()
            of_parts.append(abs(statistics.mean(by_packing[0][key] / by_packing[1][key] - 1 for key in both)))
        changes.append(max(of_parts))
    return list(np.maximum.accumulate(changes))  # a finer step is no worse


def curve(results, quantity, law, base, middles):
    parts = QUANTITIES[quantity]
    rows = [row for row in results.of(law=law, rate=1.0, filter=BASE_FILTER) if row["quantity"] in parts]
    if not rows:
        return None
    middle = float(middles[rows[0]["scene"]])
    sizes = results.values("size", parts, law=law, step=base, rate=1.0, filter=BASE_FILTER)
    errors = [setting_error(results, quantity, law=law, size=size, step=base, rate=1.0, filter=BASE_FILTER) for size in sizes]
    # A step that some run did not survive is none to propose.
    dead = {row["step"] for row in results.of(quantity="none", law=law, scene=rows[0]["scene"], rate=1.0)}
    steps = [step for step in sorted({row["step"] for row in rows if row["size"] == middle}, key=float) if step not in dead]
    prepare = straight([math.log(row["particles"] / 1000) for row in rows],
                       [math.log(row["cpu_prepare"] / row["particles"]) for row in rows])
    return "\n".join([
        f"[trade.{law}.{quantity}]",
        f"resolution = {numbers(sizes)}",
        f"bias = {numbers(error for error, _ in errors)}",
        f"spread = {numbers(spread for _, spread in errors)}",
        f"step = {numbers(map(float, steps))}",
        f"step_error = {numbers(changes_of_steps(results, parts, law, middle, steps))}",
        f"particle_step = {statistics.median(row['cpu_solve'] / row['particles'] / row['steps'] for row in rows):.3g}",
        f"prepare = {numbers([math.exp(prepare[0]), prepare[1]])}", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reference")
    parser.add_argument("results")
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--law", nargs=3, action="append", default=[])
    parser.add_argument("--middle", nargs="+", default=[])
    parser.add_argument("--name", default="pipelines/trade")
    options = parser.parse_args()
    results = Results(options.results, options.reference)
    middles = dict(one.split("=") for one in options.middle)
    text = ["# What accuracy costs, measured by pipelines/trade: docs/trade.md says what each key means.", "[trade]", "format = 1",
            f'name = "{options.name}"', f'processor = "{processor()}"   # whose seconds these are', ""]
    for law, density, base in options.law:
        rows = [row for row in results.of(law=law) if row["particles"] > 0]
        curves = [curve(results, quantity, law, base, middles) for quantity in QUANTITIES]
        if not rows or not any(curves):
            continue
        first, each = straight([row["particles"] for row in rows], [row["peak_bytes"] for row in rows])
        text += [f"[trade.{law}]", f"density = {density}", f"bytes = {numbers([max(0, first), max(0, each)])}", ""]
        text += filter(None, curves)
    options.table.write_text("\n".join(text))


main()
