# Shared by the tests of solve and relax: a small random sample and scenes.

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
}

# make_sample FILE [PARTICLES [DENSITY]]
make_sample() { packgen "$1" --particles "${2:-500}" --density "${3:-0.70}" --random-seed 3 --quiet; }

# make_scene FILE STRAIN [RATE]: phase A of the thesis with t0 = 0.1 s
make_scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 0.1

[load]
steps = [ { strain = $2, rate = ${3:-1e-2} } ]

[accuracy]
time_step = 5e-3
frames = 4
END
}

# make_plate FILE HEIGHT: 8 x 8 squares across z in ASCII STL, far wider than the sample
make_plate() {
    /usr/bin/python3 - "$@" <<'END'
import sys
print("solid plate", file=(out := open(sys.argv[1], "w")))
z, edge = float(sys.argv[2]), 5
for i in range(-4, 4):
    for j in range(-4, 4):
        a, b, c, d = ((edge * p, edge * q, z) for p, q in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
        for corners in ((a, b, c), (a, c, d)):
            print("facet normal 0 0 1\nouter loop", file=out)
            for corner in corners:
                print("vertex", *corner, file=out)
            print("endloop\nendfacet", file=out)
print("endsolid plate", file=out)
END
}

# One line on stderr that contains the text, the exit status, and no file left behind.
refuses() {
    local status=$1 text=$2
    shift 2
    local code=0
    "$@" >out.txt 2>err.txt || code=$?
    cat err.txt
    [ "$code" = "$status" ]
    [ "$(wc -l <err.txt)" = 1 ]
    grep -qF -- "$text" err.txt
    [ ! -e run.h5 ]
    [ -z "$(find . -name '*.part-*')" ]
}
