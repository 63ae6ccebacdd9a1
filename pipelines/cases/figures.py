#!/usr/bin/python3
"""The figures of a case: what the tools measured, over the packings, beside what is expected.

usage: figures.py EXPECTED.toml OUT SIZE PACKING... [--files | --check]

Writes OUT/figures.csv and prints it. --files prints the files that it reads instead; --check fails where a figure is
outside of the bounds of its size. EXPECTED.toml holds

  [[figure]]
  name = "flow stress of A"
  run = "bilin_a"                     # measured in OUT/RUN-PACKING/
  file = "stress_strain.json"         # a summary ...
  key = "flow_stress"                 # ... and what of it, as a.b or list.-1.c
  # or file = "pores.csv", column = "volume [mm^3]", and one of
  #    at = 0.3 (of "abs_strain [-]"; between two rows on a straight line), row = -1; with back = true the last time that
  #    the strain is there, as in tension after compression; or
  #    falls_below = 0.85 (the strain at which it is first below that share of its highest, behind it)
  over = { run = "bilin_b" }          # optional: the quotient; what is not said is as above
  against = { file = "m.json", key = "density" }   # optional, with over: the exponent with which the figure goes with this one
  scale = 1e-6                        # optional: unit over that of the file
  unit = "MPa"
  reference = 94.3                    # optional: what it should be, and who says so
  source = "K rate^M"
  thesis = "within 10 %"              # optional: what the thesis has
  like = "flow stress of B"           # optional: run, file, key, column, at, row ... that are not said are as there
  packings = 1                        # optional: only the first so many
  small = [80, 110]                   # bounds of the mean for each size; a size without bounds has no such figure
  full = [85, 104]
"""
import argparse
import csv
import json
import math
import pathlib
import statistics
import sys
import tomllib

COLUMNS = ["figure", "mean", "spread", "packings", "unit", "reference", "source", "thesis", "difference", "remark"]
MEASURE = ["run", "file", "key", "column", "at", "back", "row", "falls_below", "over", "scale", "unit"]


def fail(message):
    sys.exit(f"figures: {message}")


def wanted(expected, size):
    figures = {}
    for figure in tomllib.loads(expected.read_text())["figure"]:
        if "like" in figure and figure["like"] not in figures:
            fail(f"{expected}: '{figure['name']}' is like '{figure['like']}', which does not stand before it")
        earlier = figures.get(figure.get("like"), {})
        figures[figure["name"]] = {key: earlier[key] for key in MEASURE if key in earlier} | figure
    return [figure for figure in figures.values() if size in figure]


def places(figure):
    """The figure's own place; for a quotient, that of what it is divided by; for an exponent, both of the other quantity."""
    found = [figure] + ([figure | figure["over"]] if "over" in figure else [])
    return found + ([place | figure["against"] for place in found] if "against" in figure else [])


def combined(values):
    match values:
        case [value]:
            return value
        case [value, over]:
            return value / over
        case [value, over, against, against_over]:
            return math.log(value / over) / math.log(against / against_over)


def path(place, out, packing):
    return out / f"{place['run']}-{packing}" / place["file"]


def from_summary(text, key):
    value = json.loads(text)
    for part in key.split("."):
        value = value[int(part) if isinstance(value, list) else part]
    return float(value)


def from_table(rows, place):
    if "row" in place:
        return float(rows[place["row"]][place["column"]])
    strains = [float(row["abs_strain [-]"]) for row in rows]
    if "falls_below" in place:
        values = [float(row[place["column"]]) for row in rows]
        highest = max(values)
        for strain, value in list(zip(strains, values))[values.index(highest):]:
            if value < place["falls_below"] * highest:
                return strain
        fail(f"'{place['name']}' does not fall below {place['falls_below']} of its highest up to the strain {strains[-1]}")
    if place.get("back"):
        rows, strains = rows[::-1], strains[::-1]
    for before, after in zip(range(len(rows)), range(1, len(rows))):
        low, high = strains[before], strains[after]
        if min(low, high) - 1e-9 <= place["at"] <= max(low, high) + 1e-9:
            share = (place["at"] - low) / (high - low) if high != low else 0
            return (1 - share) * float(rows[before][place["column"]]) + share * float(rows[after][place["column"]])
    fail(f"no strain {place['at']} in the table, which ends at {strains[-1] if strains else 'nothing'}")


def measured(place, file):
    try:
        if file.suffix == ".json":
            return from_summary(file.read_text(), place["key"])
        with open(file) as table:
            return from_table(list(csv.DictReader(table)), place)
    except (OSError, KeyError, IndexError, ValueError, TypeError) as error:
        fail(f"{file} does not have the figure '{place['name']}': {error!r}")


def summary(figure, out, packings):
    values = []
    for packing in packings[:figure.get("packings")]:
        values.append(figure.get("scale", 1) * combined([measured(place, path(place, out, packing)) for place in places(figure)]))
    mean = statistics.fmean(values)
    spread = statistics.stdev(values) if len(values) > 1 else None
    row = {"figure": figure["name"], "mean": f"{mean:.4g}", "spread": "" if spread is None else f"{spread:.2g}",
           "packings": len(values), "unit": figure.get("unit", "-"), "source": figure.get("source", ""),
           "thesis": figure.get("thesis", "")}
    if "reference" in figure:
        reference = figure["reference"]
        row["reference"] = reference
        row["difference"] = f"{mean / reference - 1:+.1%}" if reference else f"{mean:+.3g}"
        if spread is not None and abs(mean - reference) < spread:
            row["remark"] = "less than the spread"
    return mean, row


def in_words(row):
    text = f"{row['figure']}: {row['mean']}"
    if row["spread"]:
        text += f" ± {row['spread']}"
    if row["unit"] != "-":
        text += f" {row['unit']}"
    if "reference" in row:
        text += f" ({row['difference']} from {row['reference']}, {row['source']}{', ' + row['remark'] if 'remark' in row else ''})"
    return text


def main():
    parser = argparse.ArgumentParser(prog="figures", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("expected", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("size")
    parser.add_argument("packings", nargs="+")
    parser.add_argument("--files", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    figures = wanted(options.expected, options.size)
    if options.files:
        print(*sorted({str(path(place, options.out, packing)) for figure in figures for place in places(figure)
                       for packing in options.packings[:figure.get("packings")]}))
        return

    rows, outside = [], []
    for figure in figures:
        mean, row = summary(figure, options.out, options.packings)
        rows.append(row)
        low, high = figure[options.size]
        if not low <= mean <= high:
            outside.append(f"{figure['name']}: {mean:.4g} {row['unit']}, expected {low:g} to {high:g}")
    if options.check:
        if outside:
            fail("\n  ".join([f"{len(outside)} of {len(figures)} figures are not as {options.expected} expects:", *outside]))
        return
    for row in rows:
        print(in_words(row))
    target = options.out / "figures.csv"
    with open(target.with_suffix(".part"), "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    target.with_suffix(".part").rename(target)


main()
