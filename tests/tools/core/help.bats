#!/usr/bin/env bats
# The words of every tool's --help.

@test "positionals are in capitals, and every help and purpose is a sentence" {
    /usr/bin/python3 "$TOMODEM_SOURCE/tests/tools/core/check_help.py" "$TOMODEM_BIN/tools.json"
}

@test "the check finds a positional in small letters and a help that is no sentence" {
    cat > "$BATS_TEST_TMPDIR/tools.json" <<'JSON'
[{"name": "shave", "purpose": "Shave a sheep", "arguments": [
    {"name": "sheep", "help": "Sheep to shave (.h5)."},
    {"name": "SHEEP", "help": "Sheep to shave. [.h5 or .csv; required]"},
    {"name": "--blade", "help": "which blade. [default 3]"},
    {"name": "--oil", "help": "Oil to use [default none]"}]}]
JSON
    run /usr/bin/python3 "$TOMODEM_SOURCE/tests/tools/core/check_help.py" "$BATS_TEST_TMPDIR/tools.json"
    [ "$status" -eq 1 ]
    [ "${#lines[@]}" -eq 4 ]
    [[ "$output" == *"shave: its purpose is no sentence: Shave a sheep"* ]]
    [[ "$output" == *"shave sheep: the name is not in capitals"* ]]
    [[ "$output" == *"shave --blade: its help is no sentence: which blade. [default 3]"* ]]
    [[ "$output" == *"shave --oil: its help is no sentence: Oil to use [default none]"* ]]
}
