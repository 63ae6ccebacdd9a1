#!/usr/bin/env bats
# What the cases share: the chain of a run, interruptions, figures and their bounds, scenes that are varied.

bats_require_minimum_version 1.5.0
load common
load ../common

RUN=inclusion_bilin_1e-3_2000-1  # of two_phases: seconds

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    CASES=$TOMODEM_SOURCE/pipelines/cases
}

# Cases that may be changed.
own_cases() {
    cp -r "$TOMODEM_SOURCE"/pipelines/{cases,common.mk,described.py} .
    CASES=cases
}

# The executables, but solve says what it does.
talking_solve() {
    mkdir bin
    ln -s "$TOMODEM_BIN"/* bin/
    rm bin/solve
    # shellcheck disable=SC2016
    printf '#!/bin/bash\nfor word; do [ "$word" = --quiet ] || words+=("$word"); done\nexec "%s/solve" "${words[@]}"\n' \
        "$TOMODEM_BIN" >bin/solve
    chmod +x bin/solve
    TOMODEM_BIN=bin
}

# stop_in_the_middle SIGNAL...: the run of one make after the other is stopped behind its start
stop_in_the_middle() {
    for signal in "$@"; do
        # A background job would ignore Ctrl-C, and all that it starts.
        setsid env --default-signal=INT bash -c "$(declare -f a_case); a_case two_phases out/$RUN/run.h5 >>log.txt" 3>&- &
        wait_for 60 test -e "out/$RUN/run.h5.partial"
        sleep 0.7
        kill "-$signal" -- "-$!"
        wait "$!" || true
        [ ! -e "out/$RUN/run.h5" ]
        wait_for 10 test -e "out/$RUN/run.h5.checkpoint"
    done
}

@test "a dry run shows the chain and makes nothing" {
    run -0 a_case two_phases -n check picture
    for tool in packgen vol2pack relax solve stress_strain shape_factor render figures.py picture.py; do
        [[ $output == *"/$tool "* ]]
    done
    [ ! -e out ]
}

@test "the full variant of every case can be made from nothing" {
    [ -d "${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/data" ] || skip "the real tomographies are not there (TOMODEM_SHARED)"
    for folder in "$CASES"/*/; do
        run -0 a_case "$(basename "$folder")" -n SIZE=full check picture
        [[ $output == *"/solve "* ]]
    done
    [ ! -e out ]
}

@test "a second make makes nothing, and what is named alone is made alone" {
    a_case two_phases -s "out/$RUN/sample.h5"
    [ ! -e "out/$RUN/relaxed.h5" ]
    run -0 a_case two_phases "out/$RUN/sample.h5"
    [[ $output == *"up to date"* ]]
}

@test "interrupted, killed and run again, the run is the same, and went on from its checkpoint" {
    export CASES RUN
    talking_solve
    a_case two_phases -s "out/$RUN/run.h5"
    mv out whole
    stop_in_the_middle INT KILL
    run -0 a_case two_phases -s "out/$RUN/run.h5"
    [[ $output == *"resuming at strain -0"* ]]
    same_run "whole/$RUN/run.h5" "out/$RUN/run.h5"
    [ ! -e "out/$RUN/run.h5.checkpoint" ]
}

@test "a changed scene does not resume from the checkpoint of another, and makes a finished run again" {
    own_cases
    export CASES RUN
    stop_in_the_middle INT
    sed -i 's/K = 120,/K = 60,/' cases/two_phases/scene.toml
    a_case two_phases -s "out/$RUN/run.h5"
    cp -r out/bricks bricks
    a_case two_phases -s OUT=fresh "fresh/$RUN/run.h5"
    same_run "fresh/$RUN/run.h5" "out/$RUN/run.h5"
    a_case two_phases -s PARTICLES=500 out/parallel_norton_1e-3-1/run.h5
    sed -i 's/K = 60,/K = 80,/' cases/two_phases/scene.toml
    run -0 a_case two_phases PARTICLES=500 -n out/parallel_norton_1e-3-1/run.h5
    [[ $output == *"/solve "* && $output != *"/packgen "* ]]
    run -0 a_case two_phases PARTICLES=600 -n out/parallel_norton_1e-3-1/run.h5
    [[ $output == *"/packgen "*"--particles 600"*"/solve "* ]]
}

# A case of two runs and two packings whose measures are written by hand.
made_up() {
    for packing in 1 2; do
        mkdir -p "out/soft-$packing" "out/hard-$packing"
        echo "{\"flow\": [1, {\"stress\": $((packing + 9))e6}]}" >"out/hard-$packing/m.json"
        echo "{\"flow\": [1, {\"stress\": 2e6}]}" >"out/soft-$packing/m.json"
        echo '{"density": 4}' >"out/hard-$packing/d.json"
        echo '{"density": 2}' >"out/soft-$packing/d.json"
        printf 'abs_strain [-],force\n0,0\n0.2,4\n0.4,8\n0.6,1\n' >"out/soft-$packing/c.csv"
    done
    cat >expected.toml <<'END'
[[figure]]
name = "stress"
run = "hard"
file = "m.json"
key = "flow.1.stress"
scale = 1e-6
unit = "MPa"
reference = 10
source = "a book"
small = [10, 11]
[[figure]]
name = "of one packing"
like = "stress"
packings = 1
small = [9.9, 10.1]
[[figure]]
name = "hard over soft"
like = "stress"
over = { run = "soft" }
scale = 1
unit = "-"
small = [5, 6]
[[figure]]
name = "exponent"
like = "hard over soft"
against = { file = "d.json", key = "density" }
small = [2, 3]
[[figure]]
name = "force"
run = "soft"
file = "c.csv"
column = "force"
at = 0.3
small = [5.9, 6.1]
[[figure]]
name = "fall"
run = "soft"
file = "c.csv"
column = "force"
falls_below = 0.5
reference = 0.5
small = [0.59, 0.61]
[[figure]]
name = "of the full run"
run = "none"
file = "none.json"
key = "none"
full = [0, 1]
END
    figures=$CASES/figures.py
}

@test "figures are means and spreads beside the reference; a difference smaller than the spread is called that" {
    made_up
    "$figures" expected.toml out small 1 2
    cat out/figures.csv
    grep -q '^stress,10.5,0.71,2,MPa,10,a book,,+5.0%,less than the spread$' out/figures.csv
    grep -q '^of one packing,10,,1,MPa,,,,,$' out/figures.csv
    grep -q '^hard over soft,5.25,0.35,2,-,,,,,$' out/figures.csv
    grep -q '^exponent,2.391,0.097,2,-,,,,,$' out/figures.csv
    grep -q '^force,6,0,2,-,,,,,$' out/figures.csv
    grep -q '^fall,0.6,0,2,-,0.5,,,+20.0%,$' out/figures.csv
    [ "$(wc -l <out/figures.csv)" = 7 ]
    "$figures" expected.toml out small 1 2 --check
    [ "$("$figures" expected.toml out small 1 2 --files | wc -w)" = 10 ]
}

@test "a figure outside its bounds fails with its name; one that is not there is said" {
    made_up
    sed -i 's/small = \[5.9, 6.1\]/small = [6.5, 7]/' expected.toml
    "$figures" expected.toml out small 1 2
    run -1 "$figures" expected.toml out small 1 2 --check
    [[ $output == *"1 of 6 figures are not as expected.toml expects:"*"force: 6 -, expected 6.5 to 7"* ]]
    sed -i 's/flow.1.stress/flow.1.strain/' expected.toml
    run -1 "$figures" expected.toml out small 1 2
    [[ $output == *"out/hard-1/m.json does not have the figure 'stress'"* ]]
    sed -i 's/falls_below = 0.5/falls_below = 0.1/; s/flow.1.strain/flow.1.stress/' expected.toml
    run -1 "$figures" expected.toml out small 1 2
    [[ $output == *"'fall' does not fall below 0.1 of its highest up to the strain 0.6"* ]]
}

@test "check of a case fails with the name of a figure that is outside" {
    own_cases
    sed -i '/^small = /d' cases/two_phases/expected.toml
    sed -i '0,/^full = .*/s//small = [1, 2]/' cases/two_phases/expected.toml
    name=$(sed -n '0,/^name = /s/^name = "\(.*\)"/\1/p' cases/two_phases/expected.toml)
    run ! a_case two_phases -s PARTICLES=200 check
    [[ $output == *"1 of 1 figures are not as"*"$name: "*" MPa, expected 1 to 2"* ]]
    [ -s out/figures.csv ]
}

@test "a scene is varied in place: comments and the rest stay, what is missing is added" {
    cat >scene.toml <<'END'
seed_radius = 0.5   # mm
[phase.a]           # hard
label = 1
law = "bilin"       # or norton
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
END
    "$CASES/vary.py" scene.toml phase.a.law='"norton"' seed_radius=0.4 accuracy.frames=3 load.axis='"x"' >other.toml
    diff - other.toml <<'END'
seed_radius = 0.4   # mm
[phase.a]           # hard
label = 1
law = "norton"       # or norton
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
axis = "x"

[accuracy]
frames = 3
END
    "$CASES/vary.py" scene.toml | cmp - scene.toml
    run -1 "$CASES/vary.py" scene.toml frames
    [[ $output == *"'frames' is not TABLE.KEY=VALUE"* ]]
    run -1 "$CASES/vary.py" scene.toml phase.a.label=one
    [[ $output == *"scene.toml with phase.a.label=one is no TOML"* ]]
}

@test "docs/cases.md holds the recorded figures of every case" {
    "$CASES/table.py" | diff "$TOMODEM_SOURCE/docs/cases.md" -
    for name in single_material two_phases composite casting_pores open_cell_foam; do
        grep -q "CASE=$name " "$TOMODEM_SOURCE/docs/cases.md"
        [ "$(wc -l <"$CASES/$name/README.md")" -le 16 ]
    done
}
