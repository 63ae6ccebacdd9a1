#!/usr/bin/python3
"""What law NORTON does with one phase: stress, volume, exponent, jumps of the rate, uniform flow and plane strain, each
beside K rate^M.

usage: tables.py BIN --folder FOLDER [--scheme quasi_static] [--samples 2000x3 10000x3 50000x1]
                 [--exponents 0.03 0.1 0.3 0.5 0.75 1] [--parts one fit jump uniform isochoric plane]

Samples of D = 0.64 are packed, relaxed under the law and loaded at 1e-3 /s by the executables in BIN. A stress at a strain
is the mean over 0.02 on each side.
`one`      compression and tension to 0.5 between two planes, sides free; bounds in tension hold before the sample necks.
`fit`      M from the stress at four rates with the elastic constants of the fastest (reference_rate), smallest samples.
`jump`     the rate changes at strain 0.2; stress after it over that of a run at the new rate all along, smallest samples.
`uniform`  sides periodic, without stress: no surface there. Their stress is over the current volume of the box.
`isochoric` sides periodic at constant volume; stress along the load less that across, over the constant volume.
`plane`    two walls at rest hold the sides across x: plane strain, where the stress is (2/sqrt(3))^(1+M) K rate^M.
Prints the tables; writes tables.md, tables.json and curves.png in FOLDER. Runs stay there and are not done again as long as
executables and scenes stay the same.
"""
import h5py
import numpy as np

from runs import Bench, Load, arguments, percent, pm
from samples import phase

K = 100.0  # MPa.s^M
RATE = 1e-3
STRAINS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5)
END = 0.52  # the last strain and half a window
CLAIMED = STRAINS[1:]
NECK = 0.95  # a sample in tension has begun to neck where its smallest section is below that share of the mean one
LOADS = {"compression": -1, "tension": 1}

parser = arguments(__doc__, ["one", "fit", "jump", "uniform", "isochoric", "plane"], [(2000, 3), (10000, 3), (50000, 1)])
parser.add_argument("--exponents", type=float, nargs="+", default=[0.03, 0.1, 0.3, 0.5, 0.75, 1.0], metavar="M")
parser.add_argument("--rates", type=float, nargs="+", default=[1e-3, 1e-4, 1e-5, 1e-6], help="of part fit, fastest first")
parser.add_argument("--jumps", type=float, nargs="+", default=[10, 0.1, 1000, 0.001], help="of part jump, rate over rate")
options = parser.parse_args()
bench = Bench(options.bin, options.folder, options.scheme)
small = min(options.samples)


def material(exponent):
    return phase("a", 1, (K, exponent))


def rest(size, packing, exponent, lateral="free"):
    return bench.relaxed(bench.brick(size, packing), material(exponent), f"M{exponent:g}", lateral)


def load(sign, end=END, rate=RATE, **more):
    return Load(((sign * end, rate),), options.scheme, **more)


def packings(count):
    return range(1, count + 1)


def stress_rows(title, key, cases, flow_stress, limits):
    """A table of the stresses of runs over flow_stress(M). `cases` gives (particles, M, load, runs); `limits` the bound of
    each load's claim. @return stresses by (particles, M, load, kind, strain), one a packing"""
    found = {}
    volume = "box" if key == "uniform" else "alpha shape; inside"
    bench.table(title, "particles", "M", "load", "stress of", *(f"at {strain:g}" for strain in STRAINS),
                f"volume at 0.5: {volume}", "smallest section over the mean at 0.3, 0.5", "evaluations to 0.3", "user CPU [s]")
    for size, exponent, direction, runs in cases:
        necks = {strain: np.mean([run.neck(strain) for run in runs]) for strain in STRAINS}
        volumes = {"box": [run.box_volume(0.5) for run in runs]} if key == "uniform" else dict(
            zip(("alpha shape", "inside"), np.transpose([bench.volume(run, 0.5) for run in runs])))
        for name, values in volumes.items():
            bench.keep(f"{key} {size} {exponent:g} {direction} volume, {name}", values)
            bench.claim(f"{key}: volume, {name}, {direction}", 0.01 if direction == "compression" else 0.02,
                        f"{size}, M = {exponent:g}", np.mean(values))
        for kind in runs[0].stress:
            for strain in STRAINS:
                ratio = [run.at(strain, kind) / flow_stress(exponent) for run in runs]
                found[size, exponent, direction, kind, strain] = bench.keep(
                    f"{key} {size} {exponent:g} {direction} {kind} {strain:g}", ratio)
                if strain in CLAIMED and (direction == "compression" or necks[strain] > NECK):
                    bench.claim(f"{key}: stress of {kind}, {direction}", limits[direction],
                                f"{size}, M = {exponent:g}, strain {strain:g}", np.mean(ratio) - 1)
            bench.row(size, f"{exponent:g}", direction, kind,
                      *(pm(found[size, exponent, direction, kind, strain]) for strain in STRAINS),
                      "; ".join(percent(values) for values in volumes.values()), f"{necks[0.3]:.2f}, {necks[0.5]:.2f}",
                      pm([run.evaluations_to(0.3) for run in runs], ".0f"),
                      pm([run.summary["user_seconds"] for run in runs], ".1f"))
    return found


def one():
    every = {}

    def cases():
        for size, count in options.samples:
            for exponent in options.exponents:
                for direction, sign in LOADS.items():
                    runs = [bench.run(rest(size, p, exponent), material(exponent), direction, load(sign))
                            for p in packings(count)]
                    every[size, exponent, direction] = runs
                    yield size, exponent, direction, runs

    found = stress_rows("One phase: stress over K rate^M", "one", cases(), lambda exponent: K * RATE**exponent,
                        {"compression": 0.015, "tension": 0.03})
    largest = max(options.samples)[0]
    if len(options.samples) > 1:
        bench.table(f"Number of particles: mean stress over that of {largest}", "particles", "M", "load", "stress of",
                    *(f"at {strain:g}" for strain in STRAINS))
        for size, exponent, direction in every:
            if size == largest:
                continue
            for kind in every[size, exponent, direction][0].stress:
                change = {strain: np.mean(found[size, exponent, direction, kind, strain])
                          / np.mean(found[largest, exponent, direction, kind, strain]) - 1 for strain in STRAINS}
                bench.row(size, f"{exponent:g}", direction, kind, *(percent([change[strain]], "+.2f") for strain in STRAINS))
                for strain in CLAIMED if direction == "compression" else CLAIMED[:3]:
                    bench.claim(f"one: number of particles, stress of {kind}, {direction}", 0.01,
                                f"{size}, M = {exponent:g}, strain {strain:g}", change[strain])
    draw(every)


def draw(every):
    """Stress over K rate^M against strain, of the first packing: a row of pictures a size, dashed where it is the virial."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    sizes = [size for size, _ in options.samples]
    figure, axes = plt.subplots(len(sizes), 2, figsize=(9, 3.2 * len(sizes)), sharex=True, sharey=True, squeeze=False,
                                layout="constrained")
    for (size, exponent, direction), runs in every.items():
        axis = axes[sizes.index(size), list(LOADS).index(direction)]
        colour = f"C{options.exponents.index(exponent)}"
        for kind, stress in runs[0].stress.items():
            axis.plot(runs[0].strain[1:], stress[1:] / (K * RATE**exponent), color=colour, lw=0.9,
                      ls="-" if kind == "planes" else "--", label=f"M = {exponent:g}" if kind == "planes" else None)
        axis.set_title(f"{direction}, {size} particles", fontsize=9)
    for axis in axes.flat:
        axis.axhspan(0.985, 1.015, color="0.9", zorder=0)
        axis.set(ylim=(0.8, 1.2), xlim=(0, END))
    for axis in axes[-1]:
        axis.set_xlabel("true strain")
    for axis in axes[:, 0]:
        axis.set_ylabel("stress over K rate$^M$")
    axes[0, 0].legend(fontsize=7, ncols=2)
    figure.savefig(options.folder / "curves.png", dpi=130)


def fit():
    size, count = small
    strain = 0.3
    bench.table(f"M fitted, {size} particles: stress over K rate^M at {strain:g} with the elastic constants of "
                f"{options.rates[0]:g} /s", "M", "load", "stress of", *(f"{rate:g} /s" for rate in options.rates), "M fitted",
                "less M")
    for exponent in options.exponents:
        for direction, sign in LOADS.items():
            runs = {(rate, p): bench.run(rest(size, p, exponent), material(exponent), f"{direction}-{rate:g}",
                                         load(sign, strain + 0.02, rate, accuracy=f"reference_rate = {options.rates[0]:g}\n"))
                    for rate in options.rates for p in packings(count)}
            for kind in runs[options.rates[0], 1].stress:
                stress = np.array([[runs[rate, p].at(strain, kind) for p in packings(count)] for rate in options.rates])
                fitted = bench.keep(f"fit {exponent:g} {direction} {kind}",
                                    [np.polyfit(np.log(options.rates), np.log(column), 1)[0] for column in stress.T])
                bench.row(f"{exponent:g}", direction, kind,
                          *(pm(line / (K * rate**exponent)) for line, rate in zip(stress, options.rates)), pm(fitted, ".4f"),
                          pm(fitted - exponent, "+.4f"))
                bench.claim(f"fit: M fitted from {kind}, {direction}", 0.01, f"M = {exponent:g}", np.mean(fitted) - exponent)


def ratio_row(cells, key, ratios, claims, bound, where):
    """A row of ratios that should be 1, over the packings, by what they are at; `claims` names those that are held to
    the bound."""
    found = {at: bench.keep(f"{key} {at:g}", values) for at, values in ratios.items()}
    bench.row(*cells, *map(pm, found.values()))
    for at, claim in claims.items():
        bench.claim(claim, bound, f"{where}, at {at:g}", np.mean(found[at]) - 1)


def jump():
    size, count = small
    at, after = 0.2, (0.01, 0.02, 0.05)
    accuracy = "averaging_strain = 0.001\n" if options.scheme == "explicit" else ""
    bench.table(f"The rate jumps to {RATE:g} /s at strain {at:g}, {size} particles, compression: stress over that of the run "
                "at that rate all along", "new rate over old", "M", "stress of",
                *(f"{more:g} later" for more in after))
    for factor in options.jumps:
        old, end = RATE / factor, at + after[-1] + 0.01
        for exponent in options.exponents:
            pairs = [[bench.run(rest(size, p, exponent), material(exponent), name,
                                Load(steps, options.scheme, accuracy=accuracy))
                      for name, steps in ((f"jump-{factor:g}", ((-at, old), (-end, RATE))), ("steady", ((-end, RATE),)))]
                     for p in packings(count)]
            for kind in pairs[0][0].stress:
                ratio_row((f"{factor:g}", f"{exponent:g}", kind), f"jump {factor:g} {exponent:g} {kind}",
                          {more: [first.at(at + more, kind, 0.002) / second.at(at + more, kind, 0.002)
                                  for first, second in pairs] for more in after},
                          {more: f"jump: rate times {factor:g}, stress of {kind} {more:g} later" for more in after}, 0.02,
                          f"M = {exponent:g}")


def uniform():
    def cases():
        for size, count in options.samples:
            for exponent in options.exponents:
                for direction, sign in LOADS.items():
                    yield size, exponent, direction, [
                        bench.run(rest(size, p, exponent, "periodic"), material(exponent), direction,
                                  load(sign, lateral="periodic")) for p in packings(count)]

    stress_rows("Uniform flow, sides periodic without stress: stress over K rate^M", "uniform", cases(),
                lambda exponent: K * RATE**exponent, {direction: 0.005 for direction in LOADS})


def isochoric():
    bench.table("Uniform flow at constant volume: stress along the load less that across, over K rate^M", "particles", "M",
                "load", *(f"at {strain:g}" for strain in STRAINS))
    for size, count in options.samples:
        for exponent in options.exponents:
            for direction, sign in LOADS.items():
                curves = [bench.run(rest(size, p, exponent, "isochoric"), material(exponent), direction,
                                    load(sign, lateral="isochoric", frames=52, particle_stress=True)).deviator()
                          for p in packings(count)]
                ratio_row((size, f"{exponent:g}", direction), f"isochoric {size} {exponent:g} {direction}",
                          {strain: [np.interp(strain, *curve, right=np.nan) / (K * RATE**exponent) for curve in curves]
                           for strain in STRAINS},
                          {strain: f"isochoric: stress, {direction}" for strain in CLAIMED}, 0.005,
                          f"{size}, M = {exponent:g}")


def plane():
    def cases():
        for size, count in options.samples:
            for exponent in options.exponents:
                yield size, exponent, "compression", [
                    bench.run(sample, material(exponent), "plane-strain", load(-1, walls=side_walls(sample)))
                    for sample in (rest(size, p, exponent) for p in packings(count))]

    stress_rows("Plane strain: stress over (2/sqrt(3))^(1+M) K rate^M", "plane", cases(),
                lambda exponent: K * RATE**exponent * (2 / np.sqrt(3))**(1 + exponent), {"compression": 0.02})


def side_walls(sample):
    """Two walls across x at the sides of a sample, as a scene has them; their surfaces are written beside it."""
    with h5py.File(sample) as file:
        points, radius = file["particles/all/position/value"][0], file["particles/all"].attrs["seed_radius"]
    low, high = points.min(axis=0), points.max(axis=0)
    reach = 2 * (high - low).max()  # the sample spreads along y
    gap = 0.52 * radius  # solve refuses a wall within half a seed radius
    walls = ""
    for name, x in (("left", low[0] - gap), ("right", high[0] + gap)):
        y, z = ([low[k] - reach, high[k] + reach] for k in (1, 2))
        corners = [(x, y[0], z[0]), (x, y[1], z[0]), (x, y[1], z[1]), (x, y[0], z[1])]
        faces = ((corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3]))
        surface = sample.with_name(f"{sample.stem}-{name}.stl")
        surface.write_text("solid side\n" + "".join(
            "facet normal 1 0 0\nouter loop\n" + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*point) for point in face)
            + "endloop\nendfacet\n" for face in faces) + "endsolid side\n")
        walls += f'[[wall]]\nname = "{name}"\nsurface = "{surface.name}"\nunit = "mm"\n'
    return walls


for part in options.parts:
    {"one": one, "fit": fit, "jump": jump, "uniform": uniform, "isochoric": isochoric, "plane": plane}[part]()
bench.write("tables")
