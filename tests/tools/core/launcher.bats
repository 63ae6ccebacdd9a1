#!/usr/bin/env bats
# tomodem TOOL, and what every tool has in common.

setup() { PATH="$TOMODEM_BIN:$PATH"; }

@test "the launcher lists the tools and runs them" {
    run tomodem
    [ "$status" -eq 0 ]
    for tool in packgen vol2pack relax solve mesh_recon render; do [[ "$output" == *"  $tool"* ]]; done
    run tomodem solve --version
    [ "$status" -eq 0 ]
    [[ "$output" == "solve (tomodem) "* ]]
}

@test "the launcher refuses a tool that is not there with status 2" {
    run tomodem shave
    [ "$status" -eq 2 ]
    [[ "$output" == *"there is no tool 'shave'"* ]]
}

@test "every tool says its usage with an example, and refuses nonsense with status 2 and one line" {
    for tool in "$TOMODEM_BIN"/*; do
        name=$(basename "$tool")
        [ "$name" = tomodem ] && continue
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
