#!/usr/bin/python3
"""What law NORTON does with two phases: stress and shape of a second phase beside finite elements and an exact answer.

usage: two_phases.py BIN --folder FOLDER --reference ../shared/reference [--scheme quasi_static]
                     [--samples 2000x3 10000x3 30000x1] [--parts mixtures balls spheroid]

Cubes of D = 0.64 are packed, labelled, relaxed under the law and compressed by the executables in BIN. Stresses are engineering
ones, means over 0.02 of strain on each side; a shape is S_f, height over diameter by inertia, over that at the start.
`mixtures`  phases A and B in parallel, in series, and as an inclusion (a ball of 20 % of B), at four rates, at strain 0.3:
            reference/fem, the curves without prefix (FEniCS; parallel is also the mixture law).
`balls`     M = 1 in both phases, a ball of 4 and 1 % with 5 times and 0.2 of the viscosity, at 0.1, 0.2, 0.3:
            reference/fem_pores_foams, incl4 and incl1. Samples of --balls.
`spheroid`  the same with 2 and 10 times the viscosity, balls of 1 and 0.4 %, to 0.5: the formula of Bilby, Eshelby and
            Kundu for a sphere in an infinite matrix. Samples of --balls.
Prints the tables; writes two_phases.md, two_phases.json, mixtures.png and shapes.png in FOLDER. Runs stay there and are not
done again as long as executables and scenes stay the same.
"""
import pathlib

import numpy as np

import samples
from runs import HALF_WINDOW, Bench, Load, arguments, percent, pm
from samples import PHASES, phase

STRAIN = 0.3
RATE = 1e-3  # of the linear phases, for which it means nothing
RATES = {1e-4: "1e-4", 2.15e-4: "2.15e-4", 4.64e-4: "4.64e-4", 1e-3: "1e-3"}  # as file names have them
VISCOSITY = 1e4  # MPa.s of a linear matrix

parser = arguments(__doc__, ["mixtures", "balls", "spheroid"], [(2000, 3), (10000, 3), (30000, 1)])
parser.add_argument("--reference", type=pathlib.Path, required=True, help="folder of fem and fem_pores_foams")
parser.add_argument("--rates", type=float, nargs="+", default=list(RATES), choices=RATES, help="of part mixtures")
parser.add_argument("--cases", nargs="+", default=["parallel", "series", "inclusion"], help="of part mixtures")
parser.add_argument("--balls", nargs="+", type=lambda text: tuple(map(int, text.split("x"))),
                    default=[(8000, 3), (30000, 1)], metavar="NxP", help="samples of parts balls and spheroid")
options = parser.parse_args()
bench = Bench(options.bin, options.folder, options.scheme)
fem, fem_balls = options.reference / "fem", options.reference / "fem_pores_foams"


def loaded(case, share, size, packing, phases, what, strain, rate, frames):
    """A labelled cube, relaxed and compressed to a strain and half a window more."""
    rest = bench.relaxed(bench.brick(size, packing, case, share), phases, what)
    return bench.run(rest, phases, "compression", Load(((-strain - HALF_WINDOW, rate),), options.scheme, frames=frames))


def of_fem(case, rate):
    """Files of the stress and the shape of a case."""
    suffix = "" if case == "inclusion" else "_fB0.5"
    return f"{case}_stress_strain_rate{RATES[rate]}{suffix}.csv", f"inclusion_shape_factor_rate{RATES[rate]}.csv"


def mixtures():
    both = phase("a", 1, PHASES["A"]) + phase("b", 2, PHASES["B"])
    every = {}
    bench.table(f"Two phases at strain {STRAIN:g} beside finite elements", "case", "rate [1/s]", "particles", "stress of",
                "stress [MPa]", "finite elements", "difference", "S_f", "finite elements", "difference", "evaluations to 0.3",
                "user CPU [s]")
    for case in options.cases:
        for rate in options.rates:
            stress_file, shape_file = of_fem(case, rate)
            wanted = samples.reference(fem, stress_file, STRAIN)
            for size, count in options.samples:
                runs = [loaded(case, None, size, p, both, f"AB{rate:g}", STRAIN, rate, 16) for p in range(1, count + 1)]
                every[case, rate, size] = runs
                where = f"{size}, {rate:g} /s"
                cells = ["-"] * 3
                if case == "inclusion":
                    true = samples.reference(fem, shape_file, STRAIN)
                    factors = np.array([samples.shape(run.file, STRAIN) for run in runs])
                    error = bench.keep(f"{case} {rate:g} {size} shape", factors / true - 1)
                    bench.claim(f"inclusion: S_f, {size} particles", 0.02, where, np.mean(error))
                    cells = [pm(factors), f"{true:.3f}", percent(error)]
                for kind in runs[0].stress:
                    stress = np.array([run.at(STRAIN, kind, scale=np.exp) for run in runs])
                    error = bench.keep(f"{case} {rate:g} {size} {kind}", stress / wanted - 1)
                    bench.claim(f"{case}: stress of {kind}, {size} particles", 0.03, where, np.mean(error))
                    bench.row(case, f"{rate:g}", size, kind, pm(stress, ".1f"), f"{wanted:.1f}", percent(error), *cells,
                              pm([run.evaluations_to(STRAIN) for run in runs], ".0f"),
                              pm([run.summary["user_seconds"] for run in runs], ".1f"))
    draw_mixtures(every)


def balls():
    every = {}
    at = (0.1, 0.2, 0.3)
    bench.table("Balls in a linear matrix beside finite elements", "viscosity over the matrix'", "share", "particles",
                *(f"S_f at {strain:g}, finite elements, difference" for strain in at), "stress of",
                f"stress over K rate at {STRAIN:g}, finite elements, difference")
    for contrast in (5, 0.2):
        for share in (0.04, 0.01):
            file = f"incl{100 * share:g}_M1_r{contrast:g}.csv"
            for size, count in options.balls:
                runs = linear(contrast, share, size, count, STRAIN)
                every[contrast, share, size] = runs
                where = f"{size} particles, share {share:g}"
                cells = []
                for strain in at:
                    true = samples.reference(fem_balls, file, strain, column=2)
                    factors = np.array([samples.shape(run.file, strain) for run in runs])
                    error = bench.keep(f"ball {contrast:g} {share:g} {size} {strain:g}", factors / true - 1)
                    bench.claim(f"ball of contrast {contrast:g}, {size} particles: S_f", 0.01, f"{where}, strain {strain:g}",
                                np.mean(error))
                    cells.append(f"{pm(factors, '.4f')}, {true:.4f}, {percent(error)}")
                true = samples.reference(fem_balls, file, STRAIN)
                for kind in runs[0].stress:
                    stress = np.array([run.at(STRAIN, kind, scale=np.exp) for run in runs]) / (VISCOSITY * RATE)
                    error = bench.keep(f"ball {contrast:g} {share:g} {size} {kind}", stress / true - 1)
                    bench.row(f"{contrast:g}", f"{share:g}", size, *cells, kind, f"{pm(stress)}, {true:.3f}, {percent(error)}")
    return every


def spheroid():
    every = {}
    at = (0.1, 0.2, 0.3, 0.4, 0.5)
    bench.table("Balls in a linear matrix beside the formula for an infinite one", "viscosity over the matrix'", "share",
                "particles", "of them in the ball", *(f"S_f at {strain:g}, formula, difference" for strain in at))
    for contrast in (2, 10):
        for share in (0.01, 0.004):
            for size, count in options.balls:
                runs = linear(contrast, share, size, count, at[-1])
                every[contrast, share, size] = runs
                cells = []
                for strain in at:
                    true = samples.spheroid(contrast, strain)
                    factors = np.array([samples.shape(run.file, strain) for run in runs])
                    error = bench.keep(f"spheroid {contrast:g} {share:g} {size} {strain:g}", factors / true - 1)
                    bench.claim(f"spheroid of contrast {contrast:g}, {size} particles: S_f", 0.02,
                                f"share {share:g}, strain {strain:g}", np.mean(error))
                    cells.append(f"{pm(factors, '.4f')}, {true:.4f}, {percent(error)}")
                bench.row(f"{contrast:g}", f"{share:g}", size, round(share * size), *cells)
    return every


def linear(contrast, share, size, count, strain):
    """Runs of a ball in a matrix, M = 1 in both."""
    both = phase("a", 1, (VISCOSITY, 1.0)) + phase("b", 2, (contrast * VISCOSITY, 1.0))
    frames = round((strain + HALF_WINDOW) / 0.02)
    return [loaded("inclusion", share, size, p, both, f"r{contrast:g}", strain, RATE, frames) for p in range(1, count + 1)]


def pyplot():
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    return plt


def draw_mixtures(every):
    """Stress and S_f of the first packing of the largest samples, finite elements in black."""
    plt = pyplot()
    figure, axes = plt.subplots(1, len(options.cases) + 1, figsize=(4 * len(options.cases) + 4, 3.6), layout="constrained")
    largest = max(options.samples)[0]
    for case, axis in zip(options.cases, axes):
        for k, rate in enumerate(options.rates):
            run, (stress_file, shape_file) = every[case, rate, largest][0], of_fem(case, rate)
            for kind, stress in run.stress.items():
                axis.plot(run.strain[1:], stress[1:] * np.exp(run.strain[1:]), color=f"C{k}", lw=1,
                          ls="-" if kind == "planes" else "--", label=f"{rate:g} /s" if kind == "planes" else None)
            axis.plot(*np.loadtxt(fem / stress_file, delimiter=",").T[:2], color="black", lw=0.8)
            if case == "inclusion":
                axes[-1].plot(*samples.shapes(run.file), color=f"C{k}", marker=".", lw=1)
                axes[-1].plot(*np.loadtxt(fem / shape_file, delimiter=",").T[:2], color="black", lw=0.8)
        axis.set(title=f"{case}, {largest} particles", xlabel="true strain", ylabel="engineering stress [MPa]", xlim=(0, 0.32),
                 ylim=(0, None))
    axes[0].legend(fontsize=8)
    axes[-1].set(title="inclusion", xlabel="true strain", ylabel="S_f", xlim=(0, 0.32))
    figure.savefig(options.folder / "mixtures.png", dpi=130)


def draw_shapes(runs_of_balls, runs_of_spheroids):
    """S_f of the first packing of the largest samples, finite elements or formula in black."""
    plt = pyplot()
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True, layout="constrained")
    largest = max(options.balls)[0]
    for axis, every, title in ((axes[0], runs_of_balls, "finite elements in black"),
                               (axes[1], runs_of_spheroids, "formula for an infinite matrix in black")):
        for k, ((contrast, share, size), runs) in enumerate(item for item in every.items() if item[0][2] == largest):
            axis.plot(*samples.shapes(runs[0].file), color=f"C{k}", marker=".", lw=1, label=f"{contrast:g} times, {share:.1%}")
            if axis is axes[0]:
                table = np.loadtxt(fem_balls / f"incl{100 * share:g}_M1_r{contrast:g}.csv", delimiter=",").T
                axis.plot(table[0], table[2], color="black", lw=0.8)
            else:
                strain = np.linspace(0, 0.52, 30)
                axis.plot(strain, [samples.spheroid(contrast, at) for at in strain], color="black", lw=0.8)
        axis.set_title(f"{largest} particles; {title}", fontsize=9)
        axis.set(xlabel="true strain", ylabel="S_f")
        if every:
            axis.legend(fontsize=8)
    figure.savefig(options.folder / "shapes.png", dpi=130)


if "mixtures" in options.parts:
    mixtures()
of_balls = balls() if "balls" in options.parts else {}
of_spheroids = spheroid() if "spheroid" in options.parts else {}
if of_balls or of_spheroids:
    draw_shapes(of_balls, of_spheroids)
bench.write("two_phases")
