#!/usr/bin/python3
"""Prints docs/cases.md: the recorded figures of every case.

usage: table.py > docs/cases.md        (`make docs`)
"""
import csv
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ["single_material", "two_phases", "composite", "casting_pores", "open_cell_foam", "polymer_fibres"]

INTRODUCTION = """# The cases of the thesis, computed again, and a fibre preform

Made by `make docs` from what the full run of each case recorded in its folder, `pipelines/cases/NAME` (`figures.csv`, `picture.png`).
For your own material start from the nearest case: read its README (ten lines) and change its scene.

    make case CASE=two_phases                 # the small variant: a minute, and the same figures from few particles
    make case CASE=two_phases SIZE=full       # the one below

Values are means over packings ± their standard deviation. "Less than the spread" means that the difference from the reference is smaller than that
deviation, so these runs cannot show it. The bounds within which `check` accepts a figure are in `expected.toml`."""


def cell(row):
    mean = row["mean"] + (f" ± {row['spread']}" if row["spread"] else "")
    unit = "" if row["unit"] == "-" else f" {row['unit']}"
    reference = f"{row['reference']}{unit}, {row['source']}" if row["reference"] else row["source"]
    difference = ", ".join(filter(None, (row["difference"], row["remark"])))
    return [row["figure"], mean + unit, row["packings"], row["thesis"], reference, difference]


def case(name):
    folder = HERE / name
    title = (folder / "README.md").read_text().splitlines()[0].lstrip("# ")
    where = f"../pipelines/cases/{name}"
    lines = ["", f"## {title}", "", f"`make case CASE={name} SIZE=full` ([what it is]({where}/README.md))", "",
             f"![{title}]({where}/picture.png)", "",
             "| figure | tomodem | packings | thesis | reference | difference |", "|---|---|---|---|---|---|"]
    with open(folder / "figures.csv") as table:
        lines += ["| " + " | ".join(cell(row)) + " |" for row in csv.DictReader(table)]
    return lines


def main():
    lines = [INTRODUCTION]
    for name in ORDER:
        if (HERE / name / "figures.csv").exists():
            lines += case(name)
    print("\n".join(lines))


main()
