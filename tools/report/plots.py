"""Curves as drawings inside the page (SVG), one function each; a curve that the run does not have is not drawn."""
import io
import itertools
import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it keeps its fonts, and that this takes a moment
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from words import BLUE, GREY, INDIGO, INK, ORANGE  # noqa: E402

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


def strain_axis(axes, strain):
    """Monotonous loads against |strain|; one that turns back against strain itself."""
    turns = len(strain) > 2 and np.min(np.diff(strain)) < 0 < np.max(np.diff(strain))
    axes.set(xlabel="true strain" if turns else "|true strain|")
    return strain if turns else np.abs(strain)


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


def stress(curve, scene, shares):
    """@param shares  label -> share of the sample, of a dense one of several phases"""
    def draw(axes):
        strain = strain_axis(axes, curve["strain"])
        one_way = np.all(curve["strain"] <= 0)
        sign = -1 if one_way else 1
        axes.plot(strain, sign * curve["stress_true"] / 1e6, color=INK, lw=2, label="true stress")
        axes.plot(strain, sign * curve["stress_engineering"] / 1e6, color=GREY, lw=1.4, label="engineering stress")
        of_phase = norton_of_phases(scene)
        if one_way and shares and all(label in of_phase for label in shares):
            mixture = sum(share * of_phase[label] for label, share in shares.items())
            axes.axhline(mixture / 1e6, color=BLUE, lw=1.2, ls="--", label="phases in parallel (Norton)")
        axes.set(ylabel=("compressive " if one_way else "") + "stress [MPa]")
        axes.legend(loc="lower right" if one_way else "best")

    return drawn(draw)


def shapes(objects, means):
    def draw(axes):
        at = strain_axis(axes, means["strain"])
        for name in np.unique(objects["object"]):
            rows = objects["object"] == name
            x = objects["strain"][rows] if axes.get_xlabel() == "true strain" else objects["abs_strain"][rows]
            axes.plot(x, objects["shape_factor"][rows], color=GREY, lw=0.6, alpha=0.6)
        axes.plot([], [], color=GREY, lw=0.8, label="each object")
        mean = means["shape_factor_weighted"]
        axes.plot(at, mean, color=ORANGE, lw=2.4, label="mean, by volume")
        axes.plot(at, mean[0] * np.exp(1.5 * means["strain"]), color=INK, lw=1.2, ls="--",
                  label="if it followed the planes")
        axes.set(ylabel="shape factor H/D")
        axes.legend(loc="best")

    return drawn(draw)


def volume(curve):
    def draw(axes):
        axes.plot(strain_axis(axes, curve["strain"]), 100 * curve["volume_change"], color=INK, lw=2, marker="o", ms=3)
        axes.set(ylabel="volume change [%]")

    return drawn(draw)


def equilibrium(curve):
    def draw(axes):
        known = curve["equilibrium_error"] > 0
        strain = strain_axis(axes, curve["strain"])
        axes.semilogy(strain[known], 100 * curve["equilibrium_error"][known], color=INK, lw=1.4)
        axes.set(ylabel="equilibrium error [%]", ylim=(1e-2, None))

    return drawn(draw)


def porosity(table):
    def draw(axes):
        axes.plot(strain_axis(axes, table["strain"]), 100 * table["porosity"], color=INDIGO, lw=2, marker="o", ms=3)
        axes.set(ylabel="porosity [%]", ylim=(0, None))

    return drawn(draw)


def topology(table):
    def draw(axes):
        strain = strain_axis(axes, table["strain"])
        for name, label, colour, style in (("b0", "parts", INK, "-"), ("b1", "handles", ORANGE, "--"),
                                           ("b2", "closed pores", INDIGO, "-")):
            axes.step(strain, table[name], where="mid", color=colour, ls=style, lw=1.8, label=label)
        axes.yaxis.get_major_locator().set_params(integer=True)
        axes.set(ylabel="number, of any size", ylim=(0, None))
        axes.legend(loc="best")

    return drawn(draw)
