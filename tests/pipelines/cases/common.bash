# Shared by the tests of the cases.

# a_case NAME ARGUMENT...: its pipeline at its small size, into out
a_case() {
    local name=$1
    shift
    make --no-print-directory -f "${CASES:-$TOMODEM_SOURCE/pipelines/cases}/$name/Makefile" SIZE=small OUT=out BIN="$TOMODEM_BIN" \
        THREADS=1 "$@"
}

# small_case NAME: its figures are within the bounds of its small size, and the picture is one
small_case() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    a_case "$1" -s -j2 check picture
    [ "$(head -c 4 out/picture.png | tail -c 3)" = PNG ]
    [ "$(wc -l <out/figures.csv)" -gt 1 ]
}
