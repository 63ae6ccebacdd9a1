#!/usr/bin/python3
"""Prints the scene of a run of the trade, from its name.

usage: scene.py SCENE_LAW[_RESOLUTION_STEP_RATE_FILTER_PACKING]

Without the rest of the name: to bring a sample to rest. STEP is strain_per_step. RATE is the
one of the load over 1e-3 /s, for which the constants are chosen: by reference_rate (norton), or because the sample is
pressed at that to a strain of 0.02 first.
"""
import sys

RATE = 1e-3
MIDDLE = (49.1, 7.14e-2)  # what every law can have
PHASES = {  # label, K [MPa.s^M], M
    "single": {"a": (1, *MIDDLE)},
    "inclusion": {"a": (1, 120, 3.05e-2), "b": (2, 5020, 0.490)},  # those of the finite elements
    "pore": {"a": (1, *MIDDLE)},
    "foam": {"a": (1, *MIDDLE)},
}
STRAIN = {"single": -0.36, "inclusion": -0.33, "pore": -0.21, "foam": -0.31}


def main(name):
    scene, law, *rest = name.split("_")
    step, share = (rest[1], float(rest[2])) if rest else (None, 1)
    lines = []
    for phase, (label, strength, sensitivity) in PHASES[scene].items():
        lines += [f"[phase.{phase}]", f"label = {label}", f'law = "{law}"',
                  f"norton = {{ K = {strength:g}, M = {sensitivity:g} }}"] + ["objects = true"] * (phase == "b")
    steps, accuracy = [(STRAIN[scene], RATE * share)], []
    if share < 1 and law == "norton":
        accuracy = [f"reference_rate = {RATE:g}"]
    elif share < 1:
        steps.insert(0, (-0.02, RATE))
    lines += ["[load]", "steps = [ " + ", ".join(f"{{ strain = {strain}, rate = {rate:g} }}" for strain, rate in steps) + " ]",
              "[accuracy]", f"frames = {round(abs(STRAIN[scene]) * 100)}", *accuracy]
    if step:
        lines.append(f"strain_per_step = {step}")
    return "\n".join(lines) + "\n"


print(main(sys.argv[1]), end="")
