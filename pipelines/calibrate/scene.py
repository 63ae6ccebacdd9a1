#!/usr/bin/python3
"""Prints the scene of a run of the calibration, from its name.

usage: scene.py NAME

  relax_LAW                                                            to bring a brick to rest
  bilin_PARTICLES_DENSITY_PACKING_CHI_STRAIN-PER-STEP                  chi = rate t0^2 / time_step
  trilin_PARTICLES_DENSITY_PACKING_PERIOD-RATE_compression|tension     rate times t0
  norton_PARTICLES_DENSITY_PACKING_M_RATE_compression|tension          constants of 1e-3 /s, load at RATE [1/s]

A stress is linear in the stiffness, and time has no scale but the period: the ones written here are free.
"""
import sys

STRAIN = 0.5
SEATING = 0.06  # pressed first: the planes hold a relaxed, rough face by few particles
PHASES = {
    "bilin": "repulsive_stiffness = 6.23e9\nnatural_period = {period!r}",
    "trilin": "repulsive_stiffness = 1.42e9\nnatural_period = {period!r}",
    "norton": "norton = {{ K = 100, M = {exponent} }}",
}


def scene(law, phase, targets, rate, accuracy):
    steps = ", ".join(f"{{ strain = {target}, rate = {rate!r} }}" for target in targets)
    return (f'[phase.material]\nlabel = 1\nlaw = "{law}"\n{phase}\n[load]\nsteps = [ {steps} ]\n'
            f"[accuracy]\nframes = 1\n{accuracy}\n")


def targets(direction):
    return {"compression": [-STRAIN], "tension": [-SEATING, STRAIN]}[direction]


def main(name):
    law, *values = name.split("_")
    if law == "relax":
        law, rate = values[0], 1e-3
        return scene(law, PHASES[law].format(period=1.0, exponent=0.3), [-STRAIN], rate,
                     {"bilin": "time_step = 0.05", "trilin": "time_step = 0.1", "norton": ""}[law])
    if law == "bilin":
        rate, chi, step = 1e-3, float(values[3]), float(values[4])
        period = (chi * step) ** 0.5 / rate
        return scene(law, PHASES[law].format(period=period), [-STRAIN], rate, f"time_step = {step / rate!r}")
    if law == "trilin":
        return scene(law, PHASES[law].format(period=1.0), targets(values[4]), float(values[3]), "time_step = 0.1")
    if law == "norton":
        return scene(law, PHASES[law].format(exponent=values[3]), targets(values[5]), float(values[4]),
                     "reference_rate = 1e-3")
    sys.exit(f"scene: no law '{law}'")


print(main(sys.argv[1]), end="")
