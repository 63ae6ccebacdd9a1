#!/usr/bin/python3
"""Does the flow stress keep to K rate^M within the error that solve prints? On packings that made no table.

usage: held_out.py BIN [--folder held_out] [--particles 2000 5000] [--packings 7 8] [--table TABLE.toml]

Each case is pressed at 1e-3 /s to strain 0.36; "slow" continues at a tenth of it from 0.2, with the constants of the fast
rate. Prints one line a case: stress over K rate^M at strain 0.3, the error expected, and whether it is within; then the share within.
"""
import argparse
import json
import pathlib
import subprocess

CASES = [("bilin", 0.01, 0.70), ("bilin", 0.2, 0.70), ("bilin", 0.3, 0.70), ("bilin", 0.45, 0.70),
         ("trilin", 0.0714, 0.74), ("norton", 0.3, 0.64), ("norton", 0.8, 0.64)]
LOADS = {"fast": "{ strain = -0.36, rate = 1e-3 }",
         "slow": "{ strain = -0.2, rate = 1e-3 }, { strain = -0.36, rate = 1e-4 }",
         "tension": "{ strain = -0.06, rate = 1e-3 }, { strain = 0.36, rate = 1e-3 }"}

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("held_out"))
parser.add_argument("--particles", nargs="+", type=int, default=[2000, 5000])
parser.add_argument("--packings", nargs="+", type=int, default=[7, 8])
parser.add_argument("--table", type=pathlib.Path)
options = parser.parse_args()
options.folder.mkdir(parents=True, exist_ok=True)


def tool(name, *words):
    one_thread = ["--threads", "1"] if json.loads(subprocess.check_output([options.bin / name, "--describe"]))["threads"] else []
    subprocess.run([str(options.bin / name), *map(str, words), "--quiet", *one_thread], check=True,
                   stderr=subprocess.DEVNULL)


def scene(law, exponent, load):
    step = {"bilin": "strain_per_step = 2e-5\n", "trilin": "", "norton": "reference_rate = 1e-3\n"}[law]
    own = f'calibration = "{options.table.resolve()}"\n' if options.table else ""
    return (f'[phase.a]\nlabel = 1\nlaw = "{law}"\nnorton = {{ K = {100 * 1e3**exponent!r}, M = {exponent} }}\n'
            f"[load]\nsteps = [ {LOADS[load]} ]\n[accuracy]\nframes = 1\n{step}{own}")


within = []
for law, exponent, density in CASES:
    for load in LOADS:
        if law == "bilin" and load == "tension":
            continue
        for size in options.particles:
            for packing in options.packings:
                at = lambda suffix: options.folder / f"{law}-{exponent}-{load}-{size}-{packing}{suffix}"
                brick = options.folder / f"brick-{size}-{density}-{packing}.h5"
                relaxed = options.folder / f"relaxed-{law}-{exponent if law == 'norton' else ''}-{size}-{packing}.h5"
                at(".toml").write_text(scene(law, exponent, load))
                if not brick.exists():
                    tool("packgen", brick, "--particles", size, "--density", density, "--random-seed", packing)
                if not relaxed.exists():
                    tool("relax", brick, at(".toml"), relaxed)
                if not at(".h5").exists():
                    tool("solve", relaxed, at(".toml"), at(".h5"), "--json", at(".json"))
                tool("stress_strain", at(".h5"), at(".csv"), "--at", 0.3, "--window", 0.05, "--json", at(".flow.json"))
                flow = json.loads(at(".flow.json").read_text())["flow_stress"]
                expected = json.loads(at(".json").read_text())["expected_flow"][0]
                ratio = flow / (expected["stress"] * (0.1**exponent if load == "slow" else 1))
                within.append(abs(ratio - 1) <= expected["error"])
                print(f"{law:6} M = {exponent:<6} {load:7} {size:6} particles, packing {packing}: {ratio - 1:+6.1%}, expected "
                      f"{expected['error']:.1%}{'' if within[-1] else '  OUTSIDE'}", flush=True)
print(f"within the error expected: {sum(within)} of {len(within)}")
