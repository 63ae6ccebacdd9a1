#!/usr/bin/python3
"""The picture of a case: rendered samples and curves side by side.

usage: picture.py EXPECTED.toml OUT SIZE PACKING... [--files]

Writes OUT/picture.png; --files prints the files that it reads instead. EXPECTED.toml holds, from left to right,

  [[panel]]
  size = "full"                              # optional: not in the picture of the other size
  title = "before"
  image = "inclusion_norton-1/before.png"    # in OUT
  [[panel]]
  title = "flow stress"
  x = "true strain"                          # labels of the axes
  y = "stress [MPa]"
  file = "stress_strain.csv"
  columns = ["abs_strain [-]", "abs_stress_true [Pa]"]
  scale = [1, 1e-6]                          # optional, of the columns
  runs = { bilin_a = "BILIN", norton = "NORTON" }   # run = label: every packing is a line
  each = "object [-]"                        # optional: a line for each value of this column
  levels = { "K rate^M" = 94.3 }             # optional: horizontal lines
  points = { "finite elements" = [[0.3, 151.3]] }   # optional
  log = "xy"                                 # optional: logarithmic axes
  packings = 1                               # optional: of the first so many
and before them, optionally, columns_of_panels = 3
"""
import argparse
import csv
import pathlib
import tomllib

LARGEST_WIDTH = 1600  # pixels


def drawn_runs(panel, out, packings):
    """(label, file) of each line."""
    return [(label, out / f"{run}-{packing}" / panel["file"]) for run, label in panel.get("runs", {}).items()
            for packing in packings[:panel.get("packings")]]


def files(panels, out, packings):
    for panel in panels:
        if "image" in panel:
            yield out / panel["image"]
        else:
            yield from (file for _, file in drawn_runs(panel, out, packings))


def draw_curves(axis, panel, out, packings):
    colours, scale = {}, panel.get("scale", [1, 1])
    for label, file in drawn_runs(panel, out, packings):
        with open(file) as table:
            rows = list(csv.DictReader(table))
        for one in dict.fromkeys(row[panel["each"]] for row in rows) if "each" in panel else [None]:
            its = [row for row in rows if one is None or row[panel["each"]] == one]
            xs, ys = ([factor * float(row[column] or "nan") for row in its] for factor, column in zip(scale, panel["columns"]))
            new = label not in colours
            colour = colours.setdefault(label, f"C{len(colours)}")
            axis.plot(xs, ys, color=colour, lw=1, label=label if new else None)
    for label, level in panel.get("levels", {}).items():
        axis.axhline(level, color="black", lw=0.8, ls=":")
        axis.annotate(label, (0.99, level), xycoords=("axes fraction", "data"), ha="right", va="bottom", fontsize=7)
    for k, (label, points) in enumerate(panel.get("points", {}).items()):
        axis.plot(*zip(*points), "osd^"[k % 4], color="black", ms=4, mfc="none", label=label)
    for name in panel.get("log", ""):
        getattr(axis, f"set_{name}scale")("log")
    axis.set(xlabel=panel.get("x", ""), ylabel=panel.get("y", ""))
    if "log" not in panel or "y" not in panel["log"]:
        axis.set_ylim(bottom=min(0, axis.get_ylim()[0]))
    axis.legend(fontsize=7)


def main():
    parser = argparse.ArgumentParser(prog="picture", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("expected", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("size")
    parser.add_argument("packings", nargs="+")
    parser.add_argument("--files", action="store_true")
    options = parser.parse_args()
    expected = tomllib.loads(options.expected.read_text())
    panels = [panel for panel in expected.get("panel", []) if panel.get("size", options.size) == options.size]
    if options.files:
        print(*sorted(set(map(str, files(panels, options.out, options.packings)))))
        return

    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from PIL import Image
    across = expected.get("columns_of_panels", min(3, len(panels)))
    down = -(-len(panels) // across)
    figure, axes = plt.subplots(down, across, figsize=(3.6 * across, 3.1 * down), squeeze=False, layout="constrained")
    for axis in axes.flat[len(panels):]:
        axis.axis("off")
    for axis, panel in zip(axes.flat, panels):
        if "image" in panel:
            axis.imshow(plt.imread(options.out / panel["image"]), interpolation="antialiased")
            axis.axis("off")
        else:
            draw_curves(axis, panel, options.out, options.packings)
        axis.set_title(panel.get("title", ""), fontsize=9)
    target = options.out / "picture.png"
    figure.savefig(target.with_suffix(".part"), format="png", dpi=min(130, LARGEST_WIDTH / figure.get_size_inches()[0]))
    # A palette: a third of the bytes.
    Image.open(target.with_suffix(".part")).convert("RGB").quantize(256).save(target.with_suffix(".part"), "png", optimize=True)
    target.with_suffix(".part").rename(target)


main()
