#!/usr/bin/env bats
# The sweeps of the trade at the size of a test: kept, resumed, and a table that plan takes.

bats_require_minimum_version 1.5.0

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    trade OUT=sweep -j2
}

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
}

# In the place of this shell, so that a process group of it can be killed.
trade_alone() {
    exec make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/trade/Makefile" BIN="$TOMODEM_BIN" SIZE=small SCENES=single LAWS=bilin "$@"
}
trade() { (trade_alone "$@"); }

# What a sweep measured, without what it cost.
measured() { cut -d, -f1-9 "$1/results.csv" | sort; }

@test "a dry run shows the whole chain and touches nothing" {
    run -0 trade OUT=dry SCENES="single inclusion pore foam" LAWS="bilin trilin norton" -n
    for tool in packgen phantom_foam vol2pack carve relax solve stress_strain shape_factor pores mesh_recon page.py; do
        [[ $output == *"$tool"* ]]
    done
    [ ! -e dry ]
}

@test "the page and the table come out, and plan takes the table" {
    cp -r "$BATS_FILE_TMPDIR/sweep" sweep
    grep -q '^| flow stress |' sweep/trade.md
    grep -q 'trade.svg' sweep/trade.md
    [ -s sweep/trade.svg ]
    head -c 64000 /dev/zero | tr '\0' '\1' > solid.raw
    "$TOMODEM_SOURCE/pipelines/trade/scene.py" single_bilin > scene.toml
    plan solid.raw --raw-size 40x40x40 --raw-type uint8 --voxel-size 10um --scene scene.toml --error 90% --table sweep/trade.toml \
        --json plan.json --quiet
    /usr/bin/python3 - <<'END'
import json
import tomllib
plan = json.load(open("plan.json"))
curve = tomllib.load(open("sweep/trade.toml", "rb"))["trade"]["bilin"]["flow_stress"]
assert plan["law"] == "bilin" and curve["resolution"][0] * 0.99 < plan["particles"] < curve["resolution"][-1], plan
END
}

@test "a second run does nothing, another packing makes only what is missing" {
    cp -rp "$BATS_FILE_TMPDIR/sweep" sweep
    trade OUT=sweep -q
    touch before
    sleep 0.1
    trade OUT=sweep PACKINGS="1 2 3"
    [ "$(find sweep/runs -name 'single*.json' -newer before | grep -c 'level-set_3.json')" -eq 2 ]
    [ "$(find sweep/runs -name 'single_bilin_*_?.h5' -newer before | wc -l)" -eq 2 ]
}

@test "killed in the middle and run again, the measures are the same" {
    for moment in 1 3; do
        (export -f trade_alone && exec setsid bash -c 'trade_alone OUT=killed' 3>&-) &
        sleep "$moment"
        kill -9 -- "-$!" || true
        wait "$!" || true
    done
    [ ! -e killed/trade.md ]
    trade OUT=killed
    diff <(measured killed) <(measured "$BATS_FILE_TMPDIR/sweep")
}

@test "a setting that a run does not survive is kept as that, and not proposed" {
    cp -rp "$BATS_FILE_TMPDIR/sweep" sweep
    # Steps so long that BILIN loses its planes, or is refused.
    trade OUT=sweep bilin.steps="1e-4 4e-4 0.2" 2>err.txt
    grep -q '^solve: ' err.txt
    grep -q ',none,' sweep/results.csv
    ! grep -q '^step = .*0.2' sweep/trade.toml
    grep -q 'not proposed: single, BILIN, size 300, step 0.2' sweep/trade.md
}

@test "a run that is stopped is not one that does not survive, and resumes" {
    target=stopped/runs/single_bilin_300_1e-6_1_level-set_1.h5
    trade OUT=stopped bilin.steps=1e-6 "$target" 3>&- 2>err.txt &
    for _ in $(seq 200); do [ -e "$target.partial" ] && break; sleep 0.1; done
    sleep 0.5
    pkill -TERM -f "^[^ ]*/solve .*$target"
    code=0
    wait $! || code=$?
    [ "$code" != 0 ]
    grep -q 'stopped by SIGTERM' err.txt
    [ ! -e "$target" ]
    [ -e "$target.checkpoint" ]
    trade OUT=stopped bilin.steps=1e-6 "$target"
    [ -s "$target" ]
}
