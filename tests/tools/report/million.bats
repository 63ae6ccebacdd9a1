#!/usr/bin/env bats
# The page of a million particles.

bats_require_minimum_version 1.5.0

@test "a million particles have a page that a browser opens, of a few megabytes" {
    PATH=$TOMODEM_BIN:$PATH
    here=$TOMODEM_SOURCE/tests/tools/report
    cd "$BATS_TEST_TMPDIR"
    "$here/write_shape.py" sample.h5 --edge 100 --frames 1 --curves none --pore closed
    run -0 --separate-stderr report sample.h5 sample.html --quiet
    [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
    grep -q "<td>closed</td>" sample.html
    [ "$(stat -c %s sample.html)" -lt 8000000 ]
    if command -v chromium >/dev/null; then "$here/check_page.py" loads sample.html; fi
}
