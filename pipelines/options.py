#!/usr/bin/python3
"""Decides what the user left open: the scene, the scale of the particles, which phases are told apart as objects.

Reads the summary that volume_info made of the image. Writes into the folder OUT scene.toml, and into OUT/options one small
file for each tool of the pipeline with the options that depend on the image. What depends on the load is a part of its
own, so that a sample is not made again when only the load has changed.

The phase that fills most of the image is the matrix and gets the constants of the thesis' phase A (94 MPa at 1e-3 /s,
hardly rate-sensitive); the others get those of its phase B (170 MPa, M = 0.49). Give a scene of your own for another
material.
"""
import argparse
import json
import math
import pathlib
import sys
import tomllib

LAW = {
    "matrix": "norton = { K = 95.9, M = 2.45e-3 }   # MPa.s^M",
    "inclusion": "norton = { K = 5020, M = 0.49 }      # MPa.s^M",
}
FEWEST_PARTICLES_OF_A_SHAPE = 20


def fail(message):
    sys.exit(f"options: {message}")


def arguments():
    parser = argparse.ArgumentParser(prog="options", description=__doc__.splitlines()[0])
    parser.add_argument("volume", type=pathlib.Path, help="summary of the image (volume_info --json)")
    parser.add_argument("out", type=pathlib.Path, help="folder to write into")
    parser.add_argument("part", choices=("sample", "load"), help="the options of the sample, or the scene and what it loads")
    parser.add_argument("--scene", default="", help="scene to use as it is")
    parser.add_argument("--labels", default="", help="names of the labels, as 1=matrix,2=inclusion")
    parser.add_argument("--particles", type=float, default=20000, help="about so many are wanted")
    parser.add_argument("--density", type=float, default=0.7, help="of the brick")
    parser.add_argument("--pixels-per-seed", type=float, help="instead of a number of particles")
    return parser.parse_args()


def solid_labels(volume, path):
    """Label -> row of volume_info's table, without void, the largest first."""
    if "labels" not in volume:
        fail(f"the image has {volume.get('label_count', 'too many')} different values: it is grey; give THRESHOLD=")
    solid = {row["label"]: row for row in volume["labels"] if row["label"] != 0 and row["voxels"] > 0}
    if not solid:
        fail("the image is all void (label 0); give another THRESHOLD, or other labels with RELABEL")
    return dict(sorted(solid.items(), key=lambda item: -item[1]["voxels"]))


def given_names(text, solid):
    names = {}
    for part in filter(None, text.split(",")):
        label, _, name = part.partition("=")
        if not label.strip().isdigit() or not name.strip():
            fail(f"LABELS '{text}': expected LABEL=NAME between commas, as 1=matrix,2=inclusion")
        names[int(label)] = name.strip()
    for label in solid:
        if names and label not in names:
            fail(f"LABELS does not name label {label}, which the image has; have {sorted(solid)}")
    for label in names:
        if label != 0 and label not in solid:
            fail(f"LABELS names label {label} ({names[label]}), which the image does not have; it has {sorted(solid)}")
    return names


def names_of_phases(names, solid):
    matrix, *others = solid
    made = {matrix: "matrix" if others else "solid"}
    for label in others:
        made[label] = "inclusion" if len(others) == 1 else f"inclusion{label}"
    return {label: names.get(label, made[label]) for label in solid}


def made_scene(names, solid):
    lines = ["# Made from the labels of the image; for another material, edit a copy and give it as SCENE=",
             "seed_radius = 0.5   # mm; the constants are scaled to the particles of the sample", ""]
    for position, label in enumerate(solid):
        lines += [f'[phase."{names[label]}"]', f"label = {label}", 'law = "bilin"',
                  LAW["matrix" if position == 0 else "inclusion"]]
        if position > 0:
            lines.append("objects = true")
        lines.append("")
    lines += ["[load]", 'axis = "z"', "steps = [ { strain = -0.3, rate = 1e-3 } ]", "",
              "[accuracy]", "strain_per_step = 2e-5   # larger is faster and has more inertia",
              "averaging_strain = 0.01", "frames = 30", ""]
    return "\n".join(lines)


def scale(volume, solid, options):
    """Radius of a seed in voxels."""
    if options.pixels_per_seed:
        return options.pixels_per_seed
    voxel = volume["extent_x"] / volume["size_x"]
    extent = [volume[f"extent_{axis}"] / voxel for axis in "xyz"]
    filled = sum(row["fraction"] for row in solid.values()) * math.prod(extent)
    radius = (filled * options.density / options.particles * 3 / (4 * math.pi)) ** (1 / 3)
    return max(1.0, round(radius, 2))


def main():
    options = arguments()
    volume = json.loads(options.volume.read_text())
    solid = solid_labels(volume, options.volume)
    names = given_names(options.labels, solid)

    if options.scene:
        text = pathlib.Path(options.scene).read_text()
        try:
            scene = tomllib.loads(text)
            of_scene = {phase["label"]: name for name, phase in scene["phase"].items()}
            load = scene["load"]
            strain = max(abs(step["strain"]) for step in load["steps"])
        except (tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError, ValueError) as error:
            fail(f"cannot understand scene '{options.scene}': {error}; `solve` says more")
        for label in solid:
            if label not in of_scene:
                fail(f"scene '{options.scene}' has no phase with label {label}, which the image has; "
                     f"add one, or remove the label with RELABEL={label}=0")
        names = names or {label: of_scene[label] for label in solid}
    else:
        names = names_of_phases(names, solid)
        text = made_scene(names, solid)
        load, strain = {"axis": "z"}, 0.3

    pixels = scale(volume, solid, options)
    radius = pixels * volume["extent_x"] / volume["size_x"]
    matrix, *inclusions = solid
    objects = inclusions or [matrix]
    shown = objects[0]
    voxels_of_a_particle = 4 / 3 * math.pi * pixels**3 / options.density
    largest = max(solid[label]["largest_component"] for label in objects)
    if largest < FEWEST_PARTICLES_OF_A_SHAPE * voxels_of_a_particle:
        needed = (largest / FEWEST_PARTICLES_OF_A_SHAPE * options.density * 3 / (4 * math.pi)) ** (1 / 3)
        fail(f"the largest inclusion would have {largest / voxels_of_a_particle:.0f} particles, too few to have a shape; "
             f"give PIXELS_PER_SEED={math.floor(needed * 50) / 100:g} or less (now {pixels:g}), or more PARTICLES")

    porous = sum(row["fraction"] for row in solid.values()) < 0.98
    # Bits that no shape is measured of: loose ones between the planes would carry the first load in a porous sample.
    smallest = voxels_of_a_particle * (FEWEST_PARTICLES_OF_A_SHAPE if porous else 1)

    label_list = ",".join(f"{label}={name}" for label, name in sorted(names.items()) if label in solid)
    parts = {
        "sample": {
            "options/vol2pack": f"--pixels-per-seed {pixels:g} --labels {label_list} "
                                f"--objects {','.join(map(str, sorted(objects)))} "
                                f"--min-component {math.ceil(smallest)}\n",
            "options/render": f"--labels {label_list}\n",
            "options/inclusions": f"--only-species {shown} --color {'object' if inclusions else 'phase'}\n",
            "options/mesh_recon": f"--species {shown} --probe-radius {1.6 * radius:.6g}mm\n",
            "options/shape_factor": f"--min-particles {FEWEST_PARTICLES_OF_A_SHAPE}\n",
        },
        "load": {
            "scene.toml": text,
            "options/press": f"--press {load.get('axis', 'z')}\n",
            "options/equilibrium": f"--from {2 / 3 * strain:g}\n",
        },
    }
    (options.out / "options").mkdir(parents=True, exist_ok=True)
    for name, content in parts[options.part].items():
        path = options.out / name
        part = path.with_name(path.name + ".part")
        part.write_text(content)
        part.rename(path)


main()
