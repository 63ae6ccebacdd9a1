#!/usr/bin/env bats
# The table of docs/limits.md: every case ends in the right answer or in one clear line.

@test "every extreme ends in the right answer or in one clear line" {
    cd "$BATS_TEST_TMPDIR" || exit 1
    PATH="$TOMODEM_BIN:$PATH" "$TOMODEM_SOURCE/tests/extremes/extremes_table.py" >&3
}
