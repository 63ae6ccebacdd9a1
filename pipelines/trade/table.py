#!/usr/bin/python3
"""Writes the table that `plan` uses (tools/plan/trade.toml is one).

usage: table.py REFERENCE.toml RESULTS.csv TABLE.toml [--law LAW DENSITY]... [--name NAME]
"""
import argparse
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


def change(results, part, law, step, base):
    """What a step changes against the base one, of the same samples, in the finest size that both were taken in and where it
    is another time step; 0 where there is none."""
    rows = results.of(quantity=part, law=law, rate=1.0, filter=BASE_FILTER)
    for size in sorted({row["size"] for row in rows}, reverse=True):
        of_step, of_base = ({row["packing"]: row for row in rows if row["size"] == size and row["step"] == one} for one in (step, base))
        pairs = [of_step[packing]["value"] / of_base[packing]["value"] - 1 for packing in of_step.keys() & of_base.keys()
                 if abs(float(of_step[packing]["time_step"]) / float(of_base[packing]["time_step"]) - 1) > 0.01]
        if pairs:
            return abs(statistics.mean(pairs))
    return 0.0


def changes_of_steps(results, parts, law, base, steps):
    """The greatest over what was measured; further from the base it is no less.

    Where errors are counted from this law itself, the base step has the error that the finest one takes away."""
    found = [max(change(results, part, law, step, base) for part in parts) for step in steps]
    at = steps.index(base)
    found = np.array([*np.maximum.accumulate(found[:at][::-1])[::-1], 0.0, *np.maximum.accumulate(found[at + 1:])])
    if law == "norton" and not all(results.known(part) for part in parts):
        found = np.where(np.arange(len(steps)) < at, found[0] - found, found[0] + found)
    return found


def rate_error(results, parts, law, base):
    """What has to be added, as a square, to the mean error at the rate of the constants to have that at a tenth of it."""
    found = []
    for part in parts:
        for size in {row["size"] for row in results.of(quantity=part, law=law, rate=0.1)}:
            slow, fast = (statistics.mean(results.errors(part, law=law, size=size, step=base, rate=rate, filter=BASE_FILTER))
                          for rate in (0.1, 1.0))
            found.append(max(0, slow**2 - fast**2) ** 0.5)
    return max(found, default=None)


def memory(results, rows, law):
    """Bytes without particles, and of each particle: those of single's runs, as an image's own share hides them elsewhere."""
    single = results.of(law=law, quantity="flow_stress") or rows
    each = max(0, straight([row["particles"] for row in single], [row["peak_bytes"] for row in single])[1])
    return max(row["peak_bytes"] - each * row["particles"] for row in rows), each


def no_better(values):
    """Each at least as large as those after it."""
    return np.maximum.accumulate(values[::-1])[::-1]


def prepare_cost(rows):
    """a and b of CPU seconds a + b N (N / 1000)^(1/3), relative errors squared least: a relaxation takes as many periods as the
    sample is wide."""
    seconds = np.array([row["cpu_prepare"] for row in rows])
    work = np.array([row["particles"] * (row["particles"] / 1000) ** (1 / 3) for row in rows])
    first, each = np.linalg.lstsq(np.stack([1 / seconds, work / seconds], axis=1), np.ones(len(rows)), rcond=None)[0]
    if first < 0 or each < 0:
        first, each = 0.0, np.sum(work / seconds) / np.sum((work / seconds) ** 2)
    return first, each


def curve(results, quantity, law):
    parts = QUANTITIES[quantity]
    rows = [row for row in results.of(law=law, rate=1.0, filter=BASE_FILTER) if row["quantity"] in parts]
    if not rows:
        return None
    base = results.base(quantity, law)
    scene = rows[0]["scene"]
    failed = results.of(quantity="none", law=law, scene=scene, rate=1.0)
    # A size that some packing does not survive at the base step is none to propose, nor is a step that does not hold the others.
    sizes = [size for size in results.values("size", parts, law=law, step=base, rate=1.0, filter=BASE_FILTER)
             if not any(row["size"] == size and row["step"] == base for row in failed)]
    if not sizes:
        return None
    dead = {row["step"] for row in failed if row["size"] in sizes}
    steps = [step for step in sorted({row["step"] for row in rows}, key=float) if step not in dead]
    bias, spread = np.transpose([setting_error(results, quantity, law=law, size=size, step=base, rate=1.0, filter=BASE_FILTER)
                                 for size in sizes])
    # Three packings say little of a spread, and an error may pass through 0: no size is taken for better than the finer ones.
    # The flow stress was calibrated at some size, and is right there.
    spread = no_better(spread)
    bias = bias if quantity == "flow_stress" else no_better(bias)
    slow = rate_error(results, parts, law, base)
    return "\n".join([
        f"[trade.{law}.{quantity}]",
        f"resolution = {numbers(sizes)}",
        f"bias = {numbers(bias)}",
        f"spread = {numbers(spread)}",
        f"step = {numbers(map(float, steps))}",
        f"step_error = {numbers(changes_of_steps(results, parts, law, base, steps))}",
        *([f"rate_error = {slow:.3g}"] if slow is not None else []),
        f"particle_step = {statistics.median(row['cpu_solve'] / row['particles'] / row['steps'] for row in rows):.3g}",
        f"bytes = {numbers(memory(results, rows, law))}",
        f"prepare = {numbers(prepare_cost(rows))}", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reference")
    parser.add_argument("results")
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--law", nargs=2, action="append", default=[])
    parser.add_argument("--name", default="pipelines/trade")
    options = parser.parse_args()
    results = Results(options.results, options.reference)
    text = ["# What accuracy costs, measured by pipelines/trade: docs/trade.md says what each key means.", "[trade]", "format = 1",
            f'name = "{options.name}"', f'processor = "{processor()}"   # whose seconds these are', ""]
    for law, density in options.law:
        rows = [row for row in results.of(law=law) if row["particles"] > 0]
        curves = [curve(results, quantity, law) for quantity in QUANTITIES]
        if not rows or not any(curves):
            continue
        text += [f"[trade.{law}]", f"density = {density}", ""]
        text += filter(None, curves)
    options.table.write_text("\n".join(text))


main()
