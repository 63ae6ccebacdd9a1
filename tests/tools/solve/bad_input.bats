#!/usr/bin/env bats
load common

@test "a missing sample" {
    make_scene scene.toml -0.1
    refuses 1 "cannot read SAMPLE 'none.h5'" solve none.h5 scene.toml run.h5
}

@test "a sample cut in half" {
    make_sample sample.h5
    make_scene scene.toml -0.1
    head -c $(($(stat -c %s sample.h5) / 2)) sample.h5 > half.h5
    refuses 1 "half.h5" solve half.h5 scene.toml run.h5
    refuses 1 "half.h5" relax half.h5 scene.toml run.h5
}

@test "a scene with an unknown key" {
    make_sample sample.h5
    make_scene scene.toml -0.1
    sed -i 's/natural_period/natural_perioD/' scene.toml
    refuses 1 "scene 'scene.toml' line 5: unknown key 'natural_perioD'" solve sample.h5 scene.toml run.h5
}

@test "a scene that loads BILIN in tension" {
    make_sample sample.h5
    make_scene scene.toml 0.1
    refuses 1 "line 8: the step from strain 0 to 0.1 is tension" solve sample.h5 scene.toml run.h5
}

@test "a label that the scene does not name" {
    make_sample sample.h5
    make_scene scene.toml -0.1
    sed -i 's/label = 1/label = 2/' scene.toml
    refuses 1 "has no particle: the sample has none of label 2" solve sample.h5 scene.toml run.h5
    make_scene scene.toml -0.1
    /usr/bin/python3 -c 'import h5py; h5py.File("sample.h5", "r+")["particles/all/species"][0] = 7'
    refuses 1 "no phase with label 7" solve sample.h5 scene.toml run.h5
}

@test "a run given as the sample" {
    make_sample sample.h5
    make_scene scene.toml -0.02
    solve sample.h5 scene.toml first.h5 --quiet
    refuses 1 "cannot start from 'first.h5': it is a run of 5 frames" solve first.h5 scene.toml run.h5
}

@test "under mpirun an error is said once" {
    make_sample sample.h5
    make_scene scene.toml 0.1
    run mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" sample.h5 scene.toml run.h5
    [ "$status" -ne 0 ]
    [ "$(grep -c 'is tension' <<<"$output")" = 1 ]
    [ ! -e run.h5 ]
}

@test "a full disk leaves no file, and the previous one untouched" {
    if ! mkdir small || ! mount -t tmpfs -o size=64k tmpfs small 2>/dev/null; then skip "mounting a small tmpfs needs root"; fi
    make_sample sample.h5 2000
    make_scene scene.toml -0.02
    echo previous > small/run.h5
    code=0
    solve sample.h5 scene.toml small/run.h5 --quiet 2>err.txt || code=$?
    left=$(ls -A small)
    content=$(cat small/run.h5)
    umount small
    cat err.txt
    [ "$code" = 1 ]
    [ "$(wc -l <err.txt)" = 1 ]
    [ "$left" = run.h5 ]
    [ "$content" = previous ]
}
