"""check_help.py TOOLS_JSON: prints each name and each help in the descriptions of the tools that breaks the rules, and then fails.

The name of a positional is in capitals. A purpose and a help begin with a capital and end with a period, before the
formats, range, unit and default that core/cli appends in brackets."""

import json
import pathlib
import re
import sys

# A digit, or a symbol that is written small (a formula, a file name), is no reason to write another sentence.
SENTENCE = re.compile(r"[A-Z0-9|'(].*\.( \[.*\])?", re.DOTALL)
CAPITALS = re.compile(r"[A-Z][A-Z0-9_]*")


def problems(tools):
    for tool in tools:
        name = tool["name"]
        if not SENTENCE.fullmatch(tool["purpose"]):
            yield f"{name}: its purpose is no sentence: {tool['purpose']}"
        for argument in tool["arguments"]:
            if not argument["name"].startswith("--") and not CAPITALS.fullmatch(argument["name"]):
                yield f"{name} {argument['name']}: the name is not in capitals"
            if not SENTENCE.fullmatch(argument["help"]):
                yield f"{name} {argument['name']}: its help is no sentence: {argument['help']}"


found = list(problems(json.loads(pathlib.Path(sys.argv[1]).read_text())))
print("\n".join(found))
sys.exit(bool(found))
