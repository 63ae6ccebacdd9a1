#!/usr/bin/env bats
# The calibration pipeline on a sweep small enough for a minute, and its table in a scene.

bats_require_minimum_version 1.5.0

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    calibrate OUT=sweep -j2
}

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
    table=$BATS_FILE_TMPDIR/sweep/calibration.toml
}

# In the place of this shell, so that a process group of it can be killed.
calibrate_alone() {
    exec make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/calibrate/Makefile" BIN="$TOMODEM_BIN" LAWS=bilin \
        PACKINGS="1 2" PARTICLES=500 CHI="0.05 0.2 0.64 1.28 5.1" STRAIN_PER_STEP=4e-5 CHI_CHECKED=0.64 \
        STRAINS_PER_STEP_CHECKED=8e-5 "$@"
}
calibrate() { (calibrate_alone "$@"); }

# scene [M [RATE]]: the stress at 1e-3 /s is 100 MPa
scene() {
    cat <<END
[phase.a]
label = 1
law = "bilin"
norton = { K = $(awk "BEGIN { print 100 / 1e-3 ^ ${1:-0.3} }"), M = ${1:-0.3} }
[load]
steps = [ { strain = -0.36, rate = ${2:-1e-3} } ]
[accuracy]
strain_per_step = 4e-5
frames = 1
calibration = "table.toml"
END
}

make_brick() { packgen brick.h5 --particles "${1:-500}" --density 0.70 --random-seed 9 --quiet; }

# json FILE EXPRESSION of j
json() { /usr/bin/python3 -c 'import json, sys; j = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$1" "$2"; }
holds() { [ "$(json "$@")" = True ]; }

@test "a dry run shows the whole chain and touches nothing" {
    run -0 calibrate OUT=dry -n
    for tool in packgen relax solve calibration_table scene.py; do [[ $output == *"$tool"* ]]; done
    [ ! -e dry ]
}

@test "a second run does nothing, a longer sweep makes what is missing and the table" {
    cp -rp "$BATS_FILE_TMPDIR/sweep" sweep
    calibrate OUT=sweep -q
    touch before
    sleep 0.1
    calibrate OUT=sweep CHI="0.05 0.2 0.64 1.28 2.56 5.1"
    [ sweep/calibration.toml -nt before ]
    [ "$(find sweep/runs -name 'bilin*.h5' -newer before | wc -l)" -eq 2 ]
    grep -q 'chi = \[0.05, 0.2, 0.64, 1.28, 2.56, 5.1\]' sweep/calibration.toml
}

@test "killed in the middle and run again, the table is the same" {
    for moment in 1 3; do
        (export -f calibrate_alone && exec setsid bash -c 'calibrate_alone OUT=killed' 3>&-) &
        sleep "$moment"
        kill -9 -- "-$!" || true
        wait "$!" || true
    done
    [ -d killed/runs ]
    [ ! -e killed/calibration.toml ]
    calibrate OUT=killed
    cmp killed/calibration.toml "$table"
}

@test "solve takes the table's constants: the flow stress that comes out is K rate^M within the table's error" {
    cp "$table" table.toml
    make_brick  # a packing that was not in the sweep
    # One set of constants, those of 1e-3 /s: the slow step tests M.
    scene 0.3 > fast.toml
    sed 's/steps = .*/steps = [ { strain = -0.2, rate = 1e-3 }, { strain = -0.36, rate = 2e-4 } ]/' fast.toml > slow.toml
    for name in fast slow; do
        solve brick.h5 $name.toml $name.h5 --json $name.json --quiet
        stress_strain $name.h5 $name.csv --at 0.3 --json flow.json --quiet
        flow=$(json flow.json 'j["flow_stress"]')
        wanted=$(awk "BEGIN { print 100e6 * ($([ $name = fast ] && echo 1 || echo 0.2)) ^ 0.3 }")
        json $name.json 'j["expected_flow"]'
        echo "flow stress $flow Pa, wanted $wanted Pa"
        holds $name.json "abs($flow / $wanted - 1) < j['expected_flow'][0]['error'] < 0.5"
        holds $name.json "j['expected_flow'][0]['outside'] == []"
    done
    # Not by chance: constants follow the table.
    sed -i -E 's/^flow = .*/flow = [0.5, 0.5, 0.5, 0.5, 0.5]/' table.toml
    scene 0.01 > weak.toml
    solve brick.h5 weak.toml weak.h5 --quiet
    stress_strain weak.h5 weak.csv --at 0.3 --json flow.json --quiet
    holds flow.json 'j["flow_stress"] < 0.3 * 100e6'
}

@test "the run file repeats the run without the table, and says which it was" {
    cp "$table" table.toml
    scene | sed 's/-0.36/-0.01/' > scene.toml
    make_brick
    solve brick.h5 scene.toml run.h5 --quiet
    /usr/bin/python3 - "$(sha256sum table.toml | cut -d' ' -f1)" <<'END'
import sys
import h5py
texts = []
def keep(name, node):
    texts.extend(node.attrs.values())
    if isinstance(node, h5py.Dataset):
        texts.append(node[()])
with h5py.File("run.h5") as file:
    keep("", file["parameters/tomodem"])
    file["parameters/tomodem"].visititems(keep)
texts = [text.decode() if isinstance(text, bytes) else str(text) for text in texts]
assert any(sys.argv[1] in text for text in texts), texts
open("stored.toml", "w").write(next(text for text in texts if "[calibration.bilin]" in text and "[phase.a]" in text))
END
    rm table.toml
    solve brick.h5 stored.toml again.h5 --quiet
    for run in run again; do stress_strain $run.h5 $run.csv --at 0.005 --quiet; done
    cmp run.csv again.csv
    run -1 solve brick.h5 scene.toml never.h5
    [[ $output == *"cannot read calibration 'table.toml': no such file"* ]]
}

@test "outside of what was measured, solve warns; out of reach is an error that names the law that can" {
    cp "$table" table.toml
    scene > scene.toml
    sed -i 's/steps = .*/steps = [ { strain = -0.02, rate = 1e-3 }, { strain = -0.04, rate = 1e-5 } ]/' scene.toml
    make_brick 300
    run -0 --separate-stderr solve brick.h5 scene.toml run.h5 --explain --json explain.json
    [[ $output == *"expected_flow_a"*"MPa within "*"this scene is outside"* ]]
    [[ $stderr == *"[phase.a] is outside its calibration: the rate falls to 1e-05 /s: constants for 0.0001 to 0.001 /s"* ]]
    [[ $stderr == *"300 particles, measured with 500 to 500"* ]]
    [[ $stderr == *"strain 0.04: the stress has risen to K rate^M at "* ]]
    holds explain.json 'len(j["expected_flow"][0]["outside"]) == 3 and j["calibration"] == "calibrate"'

    scene 0.8 > scene.toml
    run -1 solve brick.h5 scene.toml run.h5
    [[ $output == *'[phase.a]: a rate sensitivity M = 0.8 is out of reach of law "bilin", which holds up to 0.'*'law "norton" can'* ]]
    scene 0.07 | sed 's/"bilin"/"trilin"/' > scene.toml
    run -1 solve brick.h5 scene.toml run.h5
    [[ $output == *'has law "trilin", which the calibration '*' does not hold; make it with pipelines/calibrate LAWS=trilin'* ]]
}

@test "a table that is wrong is refused with its line" {
    scene > scene.toml
    make_brick 300
    sed 's/^chi = .*/chi = [0.2, 0.1, 0.3, 1, 2]/' "$table" > table.toml
    run -1 solve brick.h5 scene.toml run.h5
    [[ $output == *"calibration 'table.toml' line "*": chi in [calibration.bilin] must rise, from above 0"* ]]
    sed 's/^spread = .*/spread = [0.1]/' "$table" > table.toml
    run -1 solve brick.h5 scene.toml run.h5
    [[ $output == *"spread in [calibration.bilin] must be a list of 5 numbers"* ]]
    sed 's/^density/densty/' "$table" > table.toml
    run -1 solve brick.h5 scene.toml run.h5
    [[ $output == *"[calibration.bilin] has no 'density'"* ]]
    [ ! -e run.h5 ]
}
