#!/usr/bin/python3
"""Collects what a batch made into OUT/batch.csv, a row a stack, and OUT/index.html, which links the reports.

usage: collect.py STACKS OUT [--goal GOAL]

The figures are those of the tools' summaries (--json). Exit status 1, and a line a stack on stderr, if one is not done.
"""
import argparse
import csv
import fcntl
import html
import io
import json
import os
import pathlib
import sys

from stacks import stacks_of

MPA, MIB = 1e-6, 2**-20

# Column, summary, key in it, factor.
FIGURES = (
    ("particles", "run", "particles", 1),
    ("seed_radius [mm]", "sample", "seed_radius", 1),
    ("final_strain", "run", "final_strain", 1),
    ("final_stress [MPa]", "run", "final_stress", MPA),
    ("flow_stress [MPa]", "stress_strain", "flow_stress", MPA),
    ("flow_abs_strain_from", "stress_strain", "flow_abs_strain_from", 1),
    ("flow_abs_strain_to", "stress_strain", "flow_abs_strain_to", 1),
    ("objects", "sample", "objects", 1),
    ("shape_factor_first", "shape_factor", "shape_factor_first", 1),
    ("shape_factor_last", "shape_factor", "shape_factor_last", 1),
    ("volume_change", "volume_change", "volume_change_last", 1),
    ("equilibrium_error", "equilibrium", "equilibrium_error", 1),
    ("particles_lost", "run", "particles_lost", 1),
    ("time_step [s]", "run", "time_step", 1),
    ("processes", "run", "processes", 1),
)
COSTS = ("wall [s]", "cpu [s]", "peak_memory [MiB]")
# In the page: column, heading, digits.
SHOWN = (
    ("particles", "particles", 9), ("final_strain", "strain", 3), ("final_stress [MPa]", "stress at the end [MPa]", 4),
    ("flow_stress [MPa]", "flow stress [MPa]", 4), ("shape_factor_first", "shape factor, first", 4),
    ("shape_factor_last", "last", 4), ("volume_change", "volume change", 3), ("equilibrium_error", "equilibrium error", 3),
    ("wall [s]", "time [s]", 3), ("cpu [s]", "CPU time [s]", 3), ("peak_memory [MiB]", "memory [MiB]", 4),
)

STYLE = """
body { margin: 0; color: #28303c; font: 16px/1.55 system-ui, "DejaVu Sans", sans-serif; }
main { max-width: 1280px; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; } p { color: #667085; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .4rem .8rem .4rem 0; text-align: right; border-bottom: 1px solid #e3e7ed; white-space: nowrap; }
th { color: #667085; } th:first-child, td:first-child, td.words { text-align: left; }
td.words { white-space: normal; color: #b42318; } tr.sum td { font-weight: 600; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); gap: 1rem; margin-top: 2rem; }
.pictures a { color: inherit; text-decoration: none; } .pictures img { width: 100%; border: 1px solid #e3e7ed; border-radius: .5rem; }
"""


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


def row_of(name, path, folder, goal):
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
    if step:
        row |= dict(zip(COSTS, (sum(one["wall_seconds"] for one in step.values()),
                                sum(one["cpu_seconds"] for one in step.values()),
                                max(one["peak_bytes"] for one in step.values()) * MIB)))
    return row


def text_of(value, digits=6):
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def table_text(rows):
    fractions = sorted({key for row in rows for key in row if key.startswith("fraction_")})
    head = ["stack", "file", "status", "error", *fractions, *(figure[0] for figure in FIGURES), *COSTS]
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


def page_text(rows, out):
    def cells(row):
        name = html.escape(row["stack"])
        linked = f'<a href="{name}/report.html">{name}</a>' if has_report(out / row["stack"]) else name
        if row["status"] not in ("done", "unfinished"):
            log = f' (<a href="{name}/log.txt">log</a>)' if (out / row["stack"] / "log.txt").is_file() else ""
            said = html.escape(f"{row['status']}{': ' * bool(row['error'])}{row['error']}")
            return f"<td>{linked}</td><td class=words colspan={len(SHOWN)}>{said}{log}</td>"
        return f"<td>{linked}</td>" + "".join(
            f"<td>{text_of(row[column], digits).replace('-', '−') if column in row else ''}</td>" for column, _, digits in SHOWN)

    head = "<th>stack</th>" + "".join(f"<th>{html.escape(heading)}</th>" for _, heading, _ in SHOWN)
    body = "".join(f"<tr>{cells(row)}</tr>" for row in rows)
    pictures = "".join(
        f'<a href="{name}/report.html"><img loading=lazy src="{name}/picture_cut_after.png" alt=""><br>{name}</a>'
        for name in (html.escape(row["stack"]) for row in rows if row["status"] == "done")
        if (out / name / "picture_cut_after.png").is_file() and has_report(out / name))
    done = sum(row["status"] == "done" for row in rows)
    hours = sum(row.get("cpu [s]", 0) for row in rows) / 3600
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>tomodem: {len(rows)} stacks</title><style>{STYLE}</style></head><body><main><h1>{len(rows)} stacks</h1>"
        f'<p>{done} done; {hours:.3g} h of CPU time. All figures with their units: <a href="batch.csv">batch.csv</a>.</p>'
        f"<div class=scroll><table><tr>{head}</tr>{body}</table></div><div class=pictures>{pictures}</div>"
        "</main></body></html>\n"
    )


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
    parser.add_argument("--goal", default="report", help="how far each stack was meant to go")
    options = parser.parse_args()
    found, refused = stacks_of(options.stacks)
    rows = [row_of(name, path, options.out / name, options.goal) for name, path in found.items()]
    rows += [{"stack": path.name, "file": str(path), "status": "failed", "error": why} for path, why in refused.items()]
    options.out.mkdir(parents=True, exist_ok=True)
    write_if_changed(options.out / "batch.csv", table_text(rows))
    write_if_changed(options.out / "index.html", page_text(rows, options.out))
    broken = [row for row in rows if row["status"] != "done"]
    print(f"{len(rows) - len(broken)} of {len(rows)} stacks done: {options.out}/index.html, {options.out}/batch.csv")
    for row in broken:
        print(f"collect: {row['stack']}: {row['status']}{': ' * bool(row['error'])}{row['error']}", file=sys.stderr)
    sys.exit(bool(broken))


main()
