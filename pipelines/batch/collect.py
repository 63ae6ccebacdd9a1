#!/usr/bin/python3
"""Collects what a batch made into OUT/batch.csv, one row for each stack, and OUT/index.html, which links the reports.

usage: collect.py STACKS OUT BIN [--goal GOAL]

The figures are those of the tools' summaries (--json); of a measure those that it declares (BIN/tools.json). Exit status 1,
and a line for each stack on stderr, if one is not done.
"""
import argparse
import csv
import fcntl
import io
import json
import os
import pathlib
import sys

import jinja2

from stacks import stacks_of

MPA, MIB = 1e-6, 2**-20

# Of sample and run: column, summary, key in it, factor.
FIGURES = (
    ("particles", "run", "particles", 1),
    ("seed_radius [mm]", "sample", "seed_radius", 1),
    ("final_strain", "run", "final_strain", 1),
    ("final_stress [MPa]", "run", "final_stress", MPA),
    ("objects", "sample", "objects", 1),
    ("particles_lost", "run", "particles_lost", 1),
    ("time_step [s]", "run", "time_step", 1),
    ("processes", "run", "processes", 1),
)
COSTS = ("wall [s]", "cpu [s]", "peak_memory [MiB]")
# In the page, before and behind the first result of each measure: column, heading, digits.
SHOWN_OF_RUN = (("particles", "particles", 9), ("final_strain", "strain", 3), ("final_stress [MPa]", "stress at the end [MPa]", 4))
FLOW = ("flow_stress [MPa]", "flow_abs_strain_from", "flow_abs_strain_to")
UNRELIABLE = "flow_stress_unreliable [MPa]"  # the same figure, where the particles or the contacts cannot carry it
SHOWN_COSTS = (("wall [s]", "time [s]", 3), ("cpu [s]", "CPU time [s]", 3), ("peak_memory [MiB]", "memory [MiB]", 4))


def results_of_measures(tools):
    """(measure, key, column, heading, factor) of every result that a measure declares, in its order.

    A column is the key with its unit; of a key that several measures have, it begins with the name of the measure, unless
    the key does.
    """
    measures = [tool for tool in json.loads((tools / "tools.json").read_text()) if tool["display"]]
    keys = [one["key"] for tool in measures for one in tool["display"]["results"]]
    found = []
    for tool in measures:
        for one in tool["display"]["results"]:
            alone = keys.count(one["key"]) == 1 or one["key"].startswith(tool["name"])
            unit = f" [{one['unit']}]" if one["unit"] else ""
            found.append((tool["name"], one["key"], one["key"] + unit if alone else f"{tool['name']}.{one['key']}{unit}",
                          one["label"] + unit, one["factor"]))
    return found


def summaries_of(folder):
    found = {}
    for path in sorted(folder.glob("*.json")):
        try:
            one = json.loads(path.read_text())
        except (OSError, ValueError):
            continue
        if isinstance(one, dict) and "wall_seconds" in one:
            found[path.stem] = one
    return found


def at_work(folder):
    try:
        with open(folder / ".lock", "rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        pass
    return False


def status_of(folder, goal):
    """done, failed, interrupted, running, unfinished, or not begun; and a line that says more."""
    try:
        status, _, line = (folder / "status").read_text().strip().partition(": ")
    except OSError:
        return "not begun", ""
    if status == "running" and not at_work(folder):
        return "interrupted", ""
    if status == "done" and line not in (goal, "report"):
        return "unfinished", f"as far as '{line}'"
    return status, line if status != "done" else ""


def row_of(name, path, folder, goal, results):
    status, line = status_of(folder, goal)
    row = {"stack": name, "file": str(path), "status": status, "error": line}
    if status in ("not begun", "failed"):
        return row  # what is there may be of an earlier attempt
    step = summaries_of(folder)
    for phase in step.get("sample", {}).get("phases", []):
        if phase["image_fraction"] > 0 or phase["sample_fraction"] > 0:
            phase_name = phase["name"] or f"label_{phase['label']}"
            row[f"fraction_{phase_name}"] = phase["sample_fraction"]
    for column, summary, key, factor in FIGURES:
        if isinstance(step.get(summary, {}).get(key), (int, float)):
            row[column] = step[summary][key] * factor
    for measure, key, column, _, factor in results:
        if isinstance(step.get(measure, {}).get(key), (int, float)) and step[measure]["tool"] == measure:
            row[column] = step[measure][key] * factor
    if step:
        row |= dict(zip(COSTS, (sum(one["wall_seconds"] for one in step.values()),
                                sum(one["cpu_seconds"] for one in step.values()),
                                max(one["peak_bytes"] for one in step.values()) * MIB)))
    return row


def text_of(value, digits=6):
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def table_text(rows, results):
    fractions = sorted({key for row in rows for key in row if key.startswith("fraction_")})
    measured = [column for _, _, column, _, _ in results if any(column in row for row in rows)]
    head = ["stack", "file", "status", "error", *fractions, *(figure[0] for figure in FIGURES), *measured, *COSTS]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    for row in rows:
        writer.writerow([text_of(row.get(column, "")) for column in head])
    return stream.getvalue()


def has_report(folder):
    """One of the present run: an older one waits to be made again."""
    report, run = folder / "report.html", folder / "run.h5"
    return report.is_file() and run.is_file() and report.stat().st_mtime >= run.stat().st_mtime


def flow_strain(row):
    """Where the flow stress of a stack was measured; empty if it has none."""
    column, *ends = FLOW
    return "at |strain| " + " to ".join(f"{row[end]:.3g}" for end in ends) if {column, *ends} <= row.keys() else ""


def said_of_flow(row, in_head):
    """What stands below the flow stress of a stack."""
    return ", ".join(filter(None, ("unreliable" if UNRELIABLE in row else "", "" if in_head else flow_strain(row))))


def page_text(rows, out, results):
    first = {measure: (column, heading, 4) for measure, _, column, heading, _ in reversed(results)}
    measured = [first[measure] for measure in dict.fromkeys(one[0] for one in results)]
    shown = [*SHOWN_OF_RUN, *(one for one in measured if any(one[0] in row for row in rows)), *SHOWN_COSTS]
    # The strain of the flow stress stands in the head if it is that of all stacks.
    strains = {flow_strain(row) for row in rows} - {""}
    in_head = strains.pop() if len(strains) == 1 else ""
    shown = [(column, f"{heading} {in_head}".strip() if column == FLOW[0] else heading, digits) for column, heading, digits in shown]
    stacks = []
    for row in rows:
        name = row["stack"]
        stacks.append({
            "name": name, "report": has_report(out / name), "counted": row["status"] in ("done", "unfinished"),
            "said": f"{row['status']}{': ' * bool(row['error'])}{row['error']}", "log": (out / name / "log.txt").is_file(),
            "figures": [{"text": text_of(row[column], digits).replace("-", "−") if column in row else "",
                         "where": said_of_flow(row, in_head) if column == FLOW[0] else ""} for column, _, digits in shown],
            "picture": row["status"] == "done" and (out / name / "picture_cut_after.png").is_file() and has_report(out / name),
        })
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).resolve().parent), autoescape=True,
                                     trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    return environment.get_template("index.html").render(
        stacks=stacks, headings=[heading for _, heading, _ in shown], done=sum(row["status"] == "done" for row in rows),
        hours=f"{sum(row.get('cpu [s]', 0) for row in rows) / 3600:.3g}")


def write_if_changed(path, text):
    if path.is_file() and path.read_text() == text:
        return
    part = path.with_name(f".{path.name}.part-{os.getpid()}")
    part.write_text(text)
    part.rename(path)


def main():
    parser = argparse.ArgumentParser(prog="collect", description=__doc__.splitlines()[0])
    parser.add_argument("stacks", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("--goal", default="report", help="how far each stack was meant to go")
    options = parser.parse_args()
    found, refused = stacks_of(options.stacks, options.bin)
    results = results_of_measures(options.bin)
    rows = [row_of(name, path, options.out / name, options.goal, results) for name, path in found.items()]
    rows += [{"stack": path.name, "file": str(path), "status": "failed", "error": why} for path, why in refused.items()]
    options.out.mkdir(parents=True, exist_ok=True)
    write_if_changed(options.out / "batch.csv", table_text(rows, results))
    write_if_changed(options.out / "index.html", page_text(rows, options.out, results))
    broken = [row for row in rows if row["status"] != "done"]
    print(f"{len(rows) - len(broken)} of {len(rows)} stacks done: {options.out}/index.html, {options.out}/batch.csv")
    for row in broken:
        print(f"collect: {row['stack']}: {row['status']}{': ' * bool(row['error'])}{row['error']}", file=sys.stderr)
    sys.exit(bool(broken))


main()
