"""check_descriptions.py BIN TOOL...: tools.json holds what every tool says of itself, in the order of the chain."""

import json
import pathlib
import subprocess
import sys

STEPS = ["image", "sample", "plan", "run", "surface", "measure", "picture"]

described = json.loads((pathlib.Path(sys.argv[1]) / "tools.json").read_text())
own = [json.loads(subprocess.run([tool, "--describe"], capture_output=True, check=True).stdout) for tool in sys.argv[2:]]
by_name = {tool["name"]: tool for tool in own}
assert {tool["name"]: tool for tool in described} == by_name, "tools.json is not what the tools say"
assert len(described) == len(by_name)
place = [(STEPS.index(tool["step"]), tool["name"]) for tool in described]
assert place == sorted(place), place
assert {step for step, _ in place} == set(range(len(STEPS))), "a step has no tool"
