#!/usr/bin/env bats
# Pictures of a packing whose appearance is known beforehand, drawn without a screen.

bats_require_minimum_version 1.5.0

setup() {
    PATH=$TOMODEM_BIN:$PATH
    unset DISPLAY WAYLAND_DISPLAY
    export MPLCONFIGDIR=$BATS_FILE_TMPDIR/matplotlib
    here=$TOMODEM_SOURCE/tests/tools/render
    cd "$BATS_TEST_TMPDIR" || exit 1
    "$here/write_run.py" run.h5 15
}

teardown() {
    if mountpoint -q "$BATS_TEST_TMPDIR/small"; then umount "$BATS_TEST_TMPDIR/small"; fi
}

check() { "$here/check_picture.py" "$@"; }

one_line() { [ "$(wc -l <<<"$stderr")" -eq 1 ]; }

@test "a picture has the size that was asked for and is not blank" {
    render run.h5 picture.png --size 500x400
    check size picture.png 500 400
    check empty_share picture.png 0.3 0.85
}

@test "the cut shows the inclusion in the middle, the whole sample hides it" {
    # A ball of radius 0.35 edges covers pi 0.35^2 = 38 % of the cut; top and right side show matrix only.
    render run.h5 cut.png --frame 0 --cut y --size 600x450
    check orange_share cut.png 0.18 0.30
    render run.h5 cut_x.png --frame 0 --cut x --size 600x450
    check orange_share cut_x.png 0.18 0.30
    render run.h5 whole.png --frame 0 --size 600x450
    check orange_share whole.png 0 0.001
}

@test "an automatic cut goes through the only pore, off the middle, which is darker than the solid, and says where" {
    "$here/write_run.py" off.h5 15 --pore --off
    render off.h5 auto.png --cut auto --frame 0 --no-outline --size 600x450 --json auto.json
    # The pore's middle is at y = 3.75 mm, its radius 3 mm.
    /usr/bin/python3 - <<'END'
import json
import re
axis, place, unit = re.fullmatch(r"(\w) = (\S+) (mm)", json.load(open("auto.json"))["cut"]).groups()
middle = {"x": 7.5, "y": 3.75}[axis]
assert abs(float(place) - middle) < 1.2, (axis, place)
END
    check dark_share auto.png 0.004 0.1
    render off.h5 away.png --cut y --cut-place 0.75 --frame 0 --no-outline --size 600x450 --json away.json
    grep -q '"cut": "y = 11.2 mm"' away.json
    check dark_share away.png 0 0.001
}

@test "the cut goes with the material, so that both pictures show the same particles" {
    render run.h5 pair.png --cut y --cut-place 0.4 --frames first,last --names before,after --size 300x225 --json pair.json
    [ "$(echo pair*.png)" = "pair_after.png pair_before.png" ]
    render run.h5 first.png --cut y --cut-place 0.4 --frame 0 --size 300x225 --json first.json
    cmp first.png pair_before.png
    shown() { grep -o '"particles_shown": [0-9]*' "$1"; }
    [ "$(shown pair.json)" = "$(shown first.json)" ]
}

@test "one phase alone has the colour that it has in the whole" {
    render run.h5 inclusion.png --only-species 2 --no-outline --size 600x450
    check orange_share inclusion.png 0.97 1
    render run.h5 matrix.png --only-species 1 --no-outline --size 600x450
    check orange_share matrix.png 0 0.001
}

@test "before and after differ, at the same scale" {
    render run.h5 before.png --frame 0 --no-outline --size 600x450
    render run.h5 after.png --frame -1 --no-outline --size 600x450
    check same_scale before.png after.png
    run -1 cmp -s before.png after.png
}

@test "objects have colours of their own" {
    render run.h5 objects.png --color object --only-species 2 --no-outline --size 600x450
    check orange_share objects.png 0.2 0.8
}

@test "a mesh is drawn, in the place of its run" {
    # Four triangles around the middle of the sample.
    awk 'BEGIN {
        n = split("5 5 5 10 5 5 5 10 5 5 5 10", p, " ")
        split("1 3 2 1 2 4 1 4 3 2 3 4", corner, " ")
        print "solid t"
        for (f = 0; f < 4; ++f) {
            print "facet normal 0 0 0\nouter loop"
            for (k = 1; k <= 3; ++k) { c = 3 * (corner[3*f+k] - 1); print "vertex", p[c+1], p[c+2], p[c+3] }
            print "endloop\nendfacet"
        }
        print "endsolid t" }' >tetrahedron.stl
    render tetrahedron.stl alone.png --size 600x450
    check empty_share alone.png 0.2 0.9
    render tetrahedron.stl placed.png --view-of run.h5 --size 600x450
    check orange_share placed.png 0.45 1
    check empty_share placed.png 0.9 0.995
}

@test "a quantity has a colour bar with its unit, colours around zero, and pictures without one have no bar" {
    "$here/write_run.py" fields.h5 15 --fields
    render fields.h5 stress.png --color stress_zz --cut y --size 600x450 --json stress.json
    check bar stress.png 60
    # Blue is compression: the ball, 38 % of the cut.
    check share stress.png 30,90,190 0.05 0.10
    check share stress.png 190,60,50 0.15 0.45
    grep -q '"color_low": -200000000.0' stress.json
    grep -q '"color_high": "Pa"' stress.json
    render fields.h5 height.png --color height --size 600x450
    check bar height.png 60
    render fields.h5 phase.png --size 600x450
    check no_bar phase.png
}

@test "the range that is given is taken" {
    "$here/write_run.py" fields.h5 15 --fields
    render fields.h5 wide.png --color stress_zz --range -4e9,4e9 --cut y --size 600x450
    check share wide.png 30,90,190 0 0.002
    check share wide.png 190,60,50 0 0.002
}

@test "a slice is one layer, seen straight, with arrows of a vector" {
    "$here/write_run.py" fields.h5 15 --fields
    run -0 render fields.h5 slice.png --slice y --color none --no-outline --size 600x450
    [[ $output == *"particles_shown: 225"* ]]
    render fields.h5 arrows.png --slice y --color none --arrows outward --no-outline --size 600x450
    check left_right arrows.png
    run -1 check left_right slice.png
    run -0 render fields.h5 first.png --slice z --slice-place 0.01 --frame 0 --size 600x450
    [[ $output == *"particles_shown: 225"* ]]
}

@test "objects and pores are seen through the sample" {
    "$here/write_run.py" pore.h5 15 --pore
    render pore.h5 pores.png --pores --no-outline --size 600x450
    check share pores.png 61,61,143 0.02 0.2
    render pore.h5 lids.png --pores --lid-radius 7mm --no-outline --size 600x450
    check share lids.png 61,61,143 0.02 0.2
    render run.h5 none.png --pores --no-outline --size 600x450
    check share none.png 61,61,143 0 0.001
    render run.h5 objects.png --objects --no-outline --size 600x450
    check orange_share objects.png 0.05 0.4
    render run.h5 opaque.png --objects --opacity 1 --no-outline --size 600x450
    check orange_share opaque.png 0 0.001
}

@test "all frames are pictures of their numbers, in one place and scale" {
    render run.h5 all.png --frames all --no-outline --size 300x225
    [ "$(echo all*.png)" = "all_0000.png all_0001.png" ]
    render run.h5 last.png --no-outline --size 300x225
    cmp all_0001.png last.png
    check same_scale all_0000.png all_0001.png
}

@test "a turntable goes once around" {
    "$here/write_run.py" fields.h5 9 --fields
    render fields.h5 turn.png --turntable 4 --color height --no-outline --size 300x225
    [ "$(echo turn*.png)" = "turn_0000.png turn_0001.png turn_0002.png turn_0003.png" ]
    check same_scale turn_0000.png turn_0003.png
    # A cube looks the same from its four sides, but for the light and the places of the axes.
    for k in 1 2 3; do check empty_share turn_000$k.png 0.5 0.85; done
    run -1 cmp -s turn_0000.png turn_0001.png
}

@test "a movie has one picture a frame, and the same bytes each time" {
    command -v ffmpeg >/dev/null || skip "there is no ffmpeg here"
    render run.h5 run.mp4 --size 301x225 --pictures-per-second 2
    probe() { ffprobe -v error -count_frames -select_streams v -show_entries "stream=$1" -of csv=p=0 "$2"; }
    [ "$(probe codec_name,width,height,r_frame_rate,nb_read_frames run.mp4)" = "h264,302,226,2/1,2" ]
    render run.h5 again.mp4 --size 301x225 --pictures-per-second 2 --threads 1
    cmp run.mp4 again.mp4
    render run.h5 turn.mp4 --turntable 6 --size 300x225
    [ "$(probe nb_read_frames turn.mp4)" = 6 ]
}

@test "without ffmpeg a movie is refused in one line that says what to do" {
    run -1 --separate-stderr env PATH="$TOMODEM_BIN" render run.h5 run.mp4
    one_line
    [[ $stderr == *"there is no ffmpeg here; install the Debian package ffmpeg, or write numbered pictures"* ]]
    [ ! -e run.mp4 ]
}

@test "an encoder that fails leaves no movie" {
    mkdir bin
    printf '#!/bin/sh\necho "no such encoder" >&2\nexit 1\n' >bin/ffmpeg
    chmod +x bin/ffmpeg
    PATH=$PWD/bin:$PATH run -1 --separate-stderr render run.h5 run.mp4
    one_line
    [[ $stderr == *"no such encoder"* ]]
    [ -z "$(ls -A | grep mp4)" ]
}

@test "what the run does not have to show is named" {
    refused() {
        local words=$1
        shift
        run -1 --separate-stderr render "$@"
        one_line
        [[ $stderr == *"$words"* ]] || { echo "said: $stderr"; return 1; }
    }
    "$here/write_run.py" fields.h5 9 --fields
    refused "there is no 'stress_zz' to colour by; besides phase, object and none the file has nothing" \
        run.h5 no.png --color stress_zz
    refused "the file has height, outward, outward_x" fields.h5 no.png --color stress
    refused "'stress_zz' has no value in frame 0; choose another frame" fields.h5 no.png --color stress_zz --frame 0
    refused "no vector 'outward' to draw as arrows; it has none (the solver writes outward with 'self_contact = true'" \
        run.h5 no.png --slice y --arrows outward
    refused "'outward' is zero everywhere in frame 0" fields.h5 no.png --slice y --arrows outward --frame 0
    refused "probe radius" run.h5 no.png --pores --probe-radius 1m
    refused "there is nothing to draw: the slice leaves no particle" run.h5 no.png --slice y --only-species 2 --slice-place 0
    [ ! -e no.png ]
}

@test "options that do not go together are wrong usage" {
    for words in "--range 1,2" "--color height --range 2,1" "--color height --range 2" "--arrows outward" "--slice-place 0.2" \
        "--pores --color object" "--objects --only-species 1" "--opacity 0.5" "--lid-radius 5mm" "--cut y --slice y" "--pores --cut x" \
        "--cut-place 0.3" "--cut auto --cut-place 0.3" "--names a" "--frames first,last --names a" "--frames first,last --names a,a" \
        "--frames first,last --names a,b/c" "--frames last,first" \
        "--frames all --turntable 4" "--turntable 1" "--pictures-per-second 3" "--slice y --turntable 3"; do
        # shellcheck disable=SC2086
        run -2 --separate-stderr render run.h5 no.png $words
        one_line
    done
    run -2 --separate-stderr render run.h5 no.mp4 --frame 1
    [[ $stderr == *"a movie has all frames"* ]]
    [ ! -e no.png ]
}

@test "the picture is the same on any number of threads" {
    render run.h5 one.png --cut y --press z --threads 1 --size 600x450
    render run.h5 two.png --cut y --press z --threads 2 --size 600x450
    cmp one.png two.png
}

@test "a file that is no packing gives one line and no picture" {
    echo nonsense >broken.h5
    run -1 --separate-stderr render broken.h5 picture.png
    one_line
    [[ $stderr == "render: cannot read 'broken.h5'"* ]]
    [ ! -e picture.png ]
}

@test "what is not in the file is named" {
    run -1 --separate-stderr render run.h5 picture.png --frame 7
    one_line
    [[ $stderr == *"--frame 7: the file has frames 0 to "* ]]
    run -1 --separate-stderr render run.h5 picture.png --only-species 9
    one_line
    [[ $stderr == *"no particle has label 9; the packing has 1, 2"* ]]
    [ ! -e picture.png ]
}

@test "options that make no sense are wrong usage" {
    run -2 --separate-stderr render run.h5 picture.png --size 12x
    one_line
    [[ $stderr == *"--size '12x'"* ]]
    run -2 --separate-stderr render run.h5 picture.jpg
    one_line
    [[ $stderr == *".png"* ]]
    [ ! -e picture.png ]
}

@test "a full disk leaves no picture" {
    [ -w /dev/full ] || skip "no /dev/full here"
    [ "$(id -u)" -eq 0 ] && mkdir small && mount -t tmpfs -o size=8k tmpfs small || skip "a small tmpfs needs root"
    run -1 --separate-stderr render run.h5 small/picture.png
    one_line
    [[ $stderr == *"small/picture.png"* ]]
    [ -z "$(ls -A small)" ]
}
