#!/usr/bin/python3
"""Puts the tables and the plot into the page.

usage: page.py PAGE.md REFERENCE.toml TABLE.toml RESULTS.csv OUTPUT.md     (the plot goes beside it: OUTPUT.svg)
"""
import math
import pathlib
import statistics
import string
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.ticker

from trade import BASE_FILTER, QUANTITIES, Results, spread

WANTED = [0.02, 0.05, 0.10, 0.20]
TITLES = {"flow_stress": "flow stress", "composite_stress": "stress of two phases", "shape_factor": "shape factor",
          "pore_volume": "pore volume", "foam_stress": "foam stress"}
MEASURED = {"flow_stress": "flow stress", "volume": "volume", "composite_stress": "stress", "shape_factor": "S_f",
            "pore_start": "pore at the start", "pore_pressed": "pore at -0.2", "foam_stress": "stress", "foam_density": "density"}
LAWS = ["bilin", "trilin", "norton"]
PARTICLES = {"flow_stress": "particles"}


def percent(errors):
    if not errors:
        return "–"
    text = f"{100 * statistics.mean(errors):+.1f}"
    return text + (f" ± {100 * spread(errors):.1f}" if len(errors) > 1 else "")


def rows(columns, lines):
    return "\n".join(["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)] + ["| " + " | ".join(line) + " |" for line in lines])


def settings(results, quantity, trade):
    """Every setting measured: law, size, step, CPU seconds, MB, and the error of plan's table (19 runs of 20)."""
    found = []
    part = QUANTITIES[quantity][0]
    keys = {(row["law"], row["size"], row["step"]) for row in results.of(quantity=part, rate=1.0, filter=BASE_FILTER)}
    for law, size, step in keys:
        curve = trade.get(law, {}).get(quantity)
        if curve is None or size not in curve["resolution"] or float(step) not in curve["step"]:
            continue
        at = curve["resolution"].index(size)
        runs = results.of(quantity=part, law=law, size=size, step=step, rate=1.0, filter=BASE_FILTER)
        error = math.hypot(curve["bias"][at], 2 * curve["spread"][at], curve["step_error"][curve["step"].index(float(step))])
        found.append({"law": law, "size": size, "step": step, "error": error,
                      "cpu": statistics.mean(run["cpu_solve"] + run["cpu_prepare"] for run in runs),
                      "mb": statistics.mean(run["peak_bytes"] for run in runs) / 1e6,
                      "particles": statistics.mean(run["particles"] for run in runs)})
    return sorted(found, key=lambda one: one["cpu"])


def named(one, quantity):
    across = "particles" if quantity == "flow_stress" else f"across ({one['particles']:.0f})"
    return f"{one['law'].upper()}, {one['size']:g} {across}, {one['step']}"


def best(results, trade):
    lines = []
    for quantity, title in TITLES.items():
        known = settings(results, quantity, trade)
        cells = [title]
        for wanted in WANTED:
            within = [one for one in known if one["error"] <= wanted]
            cells.append(f"{named(within[0], quantity)}: {within[0]['cpu']:.2g} s, {within[0]['mb']:.0f} MB" if within else "–")
        if known:
            least = min(known, key=lambda one: one["error"])
            cells.append(f"{100 * least['error']:.1f} %: {named(least, quantity)}, {least['cpu']:.2g} s")
            lines.append(cells)
    return rows(["quantity", *(f"{100 * wanted:g} %" for wanted in WANTED), "the smallest"], lines)


def by_size(results):
    lines = []
    for quantity, title in MEASURED.items():
        for law in LAWS:
            sizes = results.values("size", [quantity], law=law, step=results.base(quantity, law), rate=1.0, filter=BASE_FILTER)
            if not sizes:
                continue
            cells = []
            for size in sizes:
                wanted = {"law": law, "size": size, "step": results.base(quantity, law), "rate": 1.0, "filter": BASE_FILTER}
                cpu = statistics.mean(row["cpu_solve"] + row["cpu_prepare"] for row in results.of(quantity=quantity, **wanted))
                cells.append(f"{size:g}: {percent(results.errors(quantity, **wanted))} ({cpu:.2g} s)")
            scene = results.of(quantity=quantity)[0]["scene"]
            lines.append([scene, title, law.upper(), *cells])
    width = max(map(len, lines), default=3)
    return rows(["scene", "error of [%]", "law", "size: mean ± spread (CPU)", *[""] * (width - 4)],
                [line + [""] * (width - len(line)) for line in lines])


def one_knob(results, key, number=float):
    """What turning one knob changes, against the base, of the same samples [%]."""
    base = {"rate": 1.0, "filter": BASE_FILTER}
    lines = []
    for quantity, title in MEASURED.items():
        for law in LAWS:
            found = results.of(quantity=quantity, law=law)
            base["step"] = results.base(quantity, law)
            for size in sorted({row["size"] for row in found}):
                cells = []
                for value in sorted({row[key] for row in found if row["size"] == size and not str(row["filter"]).startswith("probe")},
                                    key=number):
                    setting = base | {"size": size, "law": law, key: value}
                    pairs = []
                    for row in results.of(quantity=quantity, **setting):
                        pairs += [row["value"] / other["value"] - 1 for other in results.of(
                            quantity=quantity, **(base | {"size": size, "law": law}), packing=row["packing"])]
                    if pairs and value != base[key]:
                        cpu = statistics.mean(row["cpu_solve"] for row in results.of(quantity=quantity, **setting))
                        cells.append(f"{value}: {percent(pairs)} ({cpu:.2g} s)")
                if cells:
                    lines.append([found[0]["scene"], title, law.upper(), f"{size:g}", *cells])
    width = max(map(len, lines), default=5)
    return rows(["scene", "change of [%]", "law", "size", "setting: mean ± spread (CPU of solve)", *[""] * (width - 5)],
                [line + [""] * (width - len(line)) for line in lines])


def by_rate(results):
    lines = []
    for quantity, title in MEASURED.items():
        for law in LAWS:
            for row in results.of(quantity=quantity, law=law, rate=0.1)[:1]:
                wanted = {"law": law, "size": row["size"], "step": results.base(quantity, law), "filter": BASE_FILTER}
                cells = [row["scene"], title, law.upper(), f"{row['size']:g}"]
                for rate in (1.0, 0.1):
                    runs = results.of(quantity=quantity, rate=rate, **wanted)
                    cells.append(f"{percent(results.errors(quantity, rate=rate, **wanted))} "
                                 f"({statistics.mean(run['cpu_solve'] for run in runs):.2g} s)")
                lines.append(cells)
    return rows(["scene", "error of [%]", "law", "size", "1e-3 /s", "1e-4 /s"], lines)


def by_probe(results):
    lines = [[row["filter"].split()[1], percent([row["value"] / results.truth("pore_start") - 1])]
             for row in results.of(quantity="pore_start") if row["filter"].startswith("probe")]
    return rows(["probe radius over the particle diameter", "error of the pore's volume [%]"], sorted(lines))


def dead(results):
    found = sorted({f"{row['scene']}, {row['law'].upper()}, size {row['size']:g}, step {row['step']}" for row in results.of(quantity="none")})
    return "; ".join(found) if found else "none"


def draw(results, trade, path):
    figure, axes = plt.subplots(2, 3, figsize=(10.5, 6.4), layout="constrained")
    for axis, (quantity, title) in zip(axes.flat, TITLES.items()):
        known = settings(results, quantity, trade)
        if not known:
            axis.set_axis_off()
            continue
        for k, law in enumerate(LAWS):
            of_law = [one for one in known if one["law"] == law]
            axis.scatter([one["cpu"] for one in of_law], [100 * one["error"] for one in of_law], s=14, color=f"C{k}", label=law.upper())
        front, least = [], float("inf")
        for one in known:
            if one["error"] < least:
                least = one["error"]
                front.append(one)
        axis.step([one["cpu"] for one in front], [100 * one["error"] for one in front], where="post", color="0.4", lw=0.8, zorder=0)
        axis.set(xscale="log", yscale="log", title=title, xlabel="CPU [s]", ylabel="error [%]")
        for show in (axis.yaxis.set_major_formatter, axis.yaxis.set_minor_formatter):
            show(matplotlib.ticker.LogFormatter(minor_thresholds=(1.5, 0.6)))
        axis.grid(alpha=0.3, which="both", lw=0.4)
    axes.flat[0].legend(fontsize=8)
    axes.flat[-1].set_axis_off()
    plt.rcParams["svg.hashsalt"] = "tomodem"
    figure.savefig(path, metadata={"Date": None})


def main(page, reference, table, source, output):
    results = Results(source, reference)
    output = pathlib.Path(output)
    trade = tomllib.loads(pathlib.Path(table).read_text())["trade"]
    draw(results, trade, output.with_suffix(".svg"))
    text = string.Template(pathlib.Path(page).read_text()).substitute(
        plot=output.with_suffix(".svg").name, processor=trade["processor"], best=best(results, trade), sizes=by_size(results),
        steps=one_knob(results, "step"), rates=by_rate(results), filters=one_knob(results, "filter", str),
        probes=by_probe(results), dead=dead(results), runs=len({tuple(row[key] for key in ("scene", "law", "size", "step", "rate", "filter", "packing"))
                                                              for row in results.rows if not row["filter"].startswith("probe")}),
        cpu=f"{sum(row['cpu_solve'] for row in results.rows if row['quantity'] in ('flow_stress', 'composite_stress', 'pore_start', 'foam_stress') and row['cpu_solve'] > 0) / 60:.0f}")
    output.write_text(text)


main(*sys.argv[1:])
