# Shared by the tests of vol2pack: a brick, a phantom, and what a refusal looks like.
bats_require_minimum_version 1.5.0

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$TOMODEM_BIN/../tests/jittered_brick" brick.h5 --quiet
    "$TOMODEM_BIN/phantom_inclusions" composite.tif --size 80 --voxel-size 10um --fraction 0.15 --count 8 --quiet
}

setup() {
    cd "$BATS_TEST_TMPDIR"
    cp "$BATS_FILE_TMPDIR"/{brick.h5,composite.tif,composite.json} .
}

vol2pack() {
    "$TOMODEM_BIN/vol2pack" "$@"
}

# refused STATUS TEXT COMMAND...: one line on stderr, this exit status, no sample.
refused() {
    local wanted_status=$1 text=$2
    shift 2
    run --separate-stderr "$@"
    echo "status $status: $stderr"
    [ "$status" -eq "$wanted_status" ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == "vol2pack: "*"$text"* ]]
    [ ! -e out.h5 ]
    [ -z "$(find . -name '.*part*')" ]
}
