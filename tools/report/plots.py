"""The plot of a measure as a drawing inside the page (SVG), from the columns that it declares; two measures have more to show."""
import io
import itertools
import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it keeps its fonts, and that this takes a moment
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from words import BLUE, GREY, INDIGO, INK, ORANGE, in_unit  # noqa: E402

numbers = itertools.count(1)


def drawn(draw):
    with plt.rc_context({
        "font.size": 10.5, "font.family": "DejaVu Sans", "axes.spines.top": False, "axes.spines.right": False,
        "axes.edgecolor": GREY, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.grid": True,
        "grid.color": "#e9edf2", "legend.frameon": False, "svg.fonttype": "path", "svg.hashsalt": "tomodem",
    }):
        figure, axes = plt.subplots(figsize=(6.2, 4.2), layout="constrained")
        draw(axes)
        if axes.get_xlabel().startswith("|"):
            axes.set_xlim(0, None)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)
    svg = stream.getvalue()
    # Ids are unique in one drawing only; several share the page.
    number = next(numbers)
    for mark in ('id="', 'href="#', "url(#"):
        svg = svg.replace(mark, f"{mark}p{number}-")
    return svg[svg.index("<svg"):]


COLOURS = (INK, ORANGE, BLUE, INDIGO)
STRESS_UNITS = ("Pa", "kPa", "MPa", "GPa")
# A curve whose middle value is below this share of its largest would lie flat on the axis: it is drawn over a logarithmic one.
FLAT = 0.05
MOST_OBJECTS = 120  # whose curves one plot shows


def strain_axis(axes, strain):
    """Monotonous loads against |strain|; one that turns back against strain itself."""
    turns = len(strain) > 2 and np.min(np.diff(strain)) < 0 < np.max(np.diff(strain))
    axes.set(xlabel="true strain" if turns else "|true strain|")
    return strain if turns else np.abs(strain)


def of_all_particles(table):
    """The rows of all phases together, of a table that has others beside them."""
    if "species" not in table or "object" in table:
        return table
    rows = [k for k, one in enumerate(table["species"]) if one == "" or one != one]
    return {name: np.array(column)[rows] for name, column in table.items()}


def numeric(column):
    return isinstance(column, np.ndarray) and column.dtype.kind in "fiu"


def measure(name, display, table, more):
    """The declared plot, or nothing: of a single point, or where nothing changes.

    @param more  what else the page knows: scene, shares (label -> share of a dense sample of several phases), means
    """
    table = of_all_particles(table)
    x = display["x"]
    shown = [one for one in display["curves"] if numeric(table.get(one["key"]))]
    if not x or not shown or not numeric(table.get(x["key"])):
        return ""
    values = [one["factor"] * table[one["key"]] for one in shown]
    known = np.concatenate(values)
    known = known[np.isfinite(known)]
    if len(np.unique(table[x["key"]])) < 2 or not len(known) or np.all(known == known[0]):
        return ""
    pressed = x["key"] == "strain" and np.all(table["strain"] <= 0)

    def draw(axes):
        at = strain_axis(axes, table["strain"]) if x["key"] == "strain" else x["factor"] * table[x["key"]]
        if x["key"] != "strain":
            axes.set(xlabel=in_unit(x["label"], x["unit"]))
        compressive = pressed and all(one["unit"] in STRESS_UNITS for one in shown)
        lines = [-one for one in values] if compressive else values
        counts = all(not one["unit"] for one in shown) and np.all(known == np.rint(known))
        flat = np.min(known) >= 0 and np.median(known) < FLAT * np.max(known) and not counts
        for one, line, colour in zip(shown, lines, itertools.cycle(COLOURS)):
            if "object" in table:
                objects = np.unique(table["object"])
                drawn_ones = objects[:: -(-len(objects) // MOST_OBJECTS)]
                for number in drawn_ones:
                    rows = table["object"] == number
                    axes.plot(at[rows], line[rows], color=GREY, lw=0.6, alpha=0.6)
                of_all = "" if len(drawn_ones) == len(objects) else f" ({len(drawn_ones)} of {len(objects)} drawn)"
                axes.plot([], [], color=GREY, lw=0.8, label=f"each object{of_all}")
            elif counts:
                axes.step(at, line, where="mid", color=colour, lw=1.8, label=one["label"])
            else:
                rows = line > 0 if flat else np.isfinite(line)
                axes.plot(at[rows], line[rows], color=colour, lw=1.8, marker="o" if len(at) <= 100 else None, ms=3, label=one["label"])
        units = {one["unit"] for one in shown}
        label = shown[0]["label"] if len(shown) == 1 else "stress" if compressive else "number" if counts else ""
        axes.set(ylabel=in_unit(("compressive " if compressive else "") + label, units.pop() if len(units) == 1 else ""))
        if flat:
            axes.set_yscale("log")
        elif counts or (len(shown) == 1 and shown[0]["unit"] == "%" and np.min(known) >= 0):
            axes.set(ylim=(0, None))
        if counts:
            axes.yaxis.get_major_locator().set_params(integer=True)
        ADDED.get(name, lambda *_: None)(axes, at, pressed, more)
        if len(axes.get_legend_handles_labels()[0]) > 1:
            axes.legend(loc="best")

    return drawn(draw)


def norton_of_phases(scene):
    """Label -> flow stress [Pa] at the rate of the first step, for the phases given by their Norton law."""
    steps = scene.get("load", {}).get("steps", [])
    if not steps or not isinstance(steps[0].get("rate"), (int, float)):
        return {}
    return {
        phase["label"]: 1e6 * phase["norton"]["K"] * steps[0]["rate"] ** phase["norton"]["M"]
        for phase in scene["phase"].values()
        if isinstance(phase.get("norton"), dict) and {"K", "M"} <= phase["norton"].keys()
    }


def mixture(axes, _, pressed, more):
    """The flow stress of the phases in parallel, beside the stress of the whole."""
    of_phase, shares = norton_of_phases(more["scene"]), more["shares"]
    if pressed and shares and all(label in of_phase for label in shares):
        stress = sum(share * of_phase[label] for label, share in shares.items())
        axes.axhline(stress / 1e6, color=BLUE, lw=1.2, ls="--", label="phases in parallel (Norton)")


def mean_shape(axes, _, __, more):
    """The mean of the objects, and the shape of one that follows the planes."""
    means = more["means"]
    at = means["strain"] if axes.get_xlabel() == "true strain" else np.abs(means["strain"])
    mean = means["shape_factor_weighted"]
    axes.plot(at, mean, color=ORANGE, lw=2.4, label="mean, by volume")
    axes.plot(at, mean[0] * np.exp(1.5 * means["strain"]), color=INK, lw=1.2, ls="--", label="if it followed the planes")


ADDED = {"stress_strain": mixture, "shape_factor": mean_shape}
