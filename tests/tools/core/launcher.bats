#!/usr/bin/env bats
# tomodem TOOL, tools.json, and what every tool has in common.
bats_require_minimum_version 1.5.0

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    tools=$(find "$TOMODEM_BIN" -maxdepth 1 -type f -executable ! -name tomodem | sort)
}

@test "the launcher lists every tool under the step of the chain that it declares, and runs it" {
    run tomodem
    [ "$status" -eq 0 ]
    for tool in $tools; do
        line=$(grep "^  $(basename "$tool")  " <<<"$output")
        [ "$(wc -l <<<"$line")" = 1 ]
    done
    [[ "$output" == *"Make a sample"*"  vol2pack "*"Measures of a run"*"  stress_strain "*"Pictures"*"  render "* ]]
    [[ "$output" != *"Other tools"* ]]
    run tomodem solve --version
    [ "$status" -eq 0 ]
    [[ "$output" == "solve (tomodem) "* ]]
}

@test "the launcher refuses a tool that is not there with status 2" {
    run tomodem shave
    [ "$status" -eq 2 ]
    [[ "$output" == *"there is no tool 'shave'"* ]]
}

@test "tools.json describes every tool as the tool itself does, in the order of the chain" {
    /usr/bin/python3 "$TOMODEM_SOURCE/tests/tools/core/check_descriptions.py" "$TOMODEM_BIN" $tools
}

@test "an executable that does not describe itself is named and left out of the list" {
    printf '#!/bin/sh\nexit 3\n' > "$BATS_TEST_TMPDIR/mute"
    chmod +x "$BATS_TEST_TMPDIR/mute"
    ln -s "$TOMODEM_BIN/packgen" "$BATS_TEST_TMPDIR/packgen"
    run --separate-stderr "$TOMODEM_SOURCE/tools/launcher/list_tools" "$BATS_TEST_TMPDIR"
    [ "$status" -eq 0 ]
    [ "$(grep -c '^  "name":' <<<"$output")" = 1 ]
    [[ "$stderr" == *"mute does not answer --describe"* ]]
}

@test "every tool says its usage with an example, and refuses nonsense with status 2 and one line" {
    for tool in $tools; do
        name=$(basename "$tool")
        "$tool" --help > "$BATS_TEST_TMPDIR/help.txt"
        grep -q "^usage: $name" "$BATS_TEST_TMPDIR/help.txt"
        grep -q "^examples:" "$BATS_TEST_TMPDIR/help.txt"
        code=0
        "$tool" --no-such-option 2>"$BATS_TEST_TMPDIR/err.txt" || code=$?
        echo "$name: $(cat "$BATS_TEST_TMPDIR/err.txt")"
        [ "$code" = 2 ]
        [ "$(wc -l <"$BATS_TEST_TMPDIR/err.txt")" = 1 ]
    done
}

@test "the reference page is what the tools say" {
    "$TOMODEM_SOURCE/docs/make_reference" "$TOMODEM_BIN" | diff "$TOMODEM_SOURCE/docs/reference.md" -
}
