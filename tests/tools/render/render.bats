#!/usr/bin/env bats
# Pictures of a packing whose appearance is known beforehand, drawn without a screen.

bats_require_minimum_version 1.5.0

setup() {
    PATH=$TOMODEM_BIN:$PATH
    unset DISPLAY WAYLAND_DISPLAY
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
    check orange_share placed.png 0.5 1
    check empty_share placed.png 0.9 0.995
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
    [[ $stderr == *"no frame 7"* ]]
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
