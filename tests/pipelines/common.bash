# Shared by the tests of batches: tiny stacks and scenes.

# make_stack FILE RANDOM_SEED
make_stack() {
    "$TOMODEM_BIN/phantom_inclusions" "$1" --size 40 --voxel-size 10um --fraction 0.2 --count 3 --gap 2 --random-seed "$2" \
        --truth truth.json --quiet
}

# make_scene FILE STRAIN_PER_STEP [FRAMES]: small steps make a long run
make_scene() {
    cat >"$1" <<END
[phase.matrix]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[phase.inclusion]
label = 2
law = "bilin"
norton = { K = 5020, M = 0.49 }
objects = true
[load]
axis = "z"
steps = [ { strain = -0.04, rate = 1e-3 } ]
[accuracy]
strain_per_step = $2
frames = ${3:-4}
END
}

# pipeline NAME ARGUMENT...: a pipeline at the size of a test
pipeline() {
    local name=$1
    shift
    make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/$name/Makefile" BIN="$TOMODEM_BIN" STACKS=stacks PARTICLES=1200 \
        BRICK_PARTICLES=800 PICTURE_SIZE=240x180 "$@"
}

# same_run FIRST SECOND: the same frames and curves, bit by bit
same_run() {
    /usr/bin/python3 - "$@" <<'END'
import sys

import h5py

first, second = map(h5py.File, sys.argv[1:])
differ = []


def compare(name, item):
    if isinstance(item, h5py.Dataset) and not name.startswith("parameters"):
        if item[()].tobytes() != second[name][()].tobytes():
            differ.append(name)


first.visititems(compare)
assert not differ, differ
END
}

# wait_for SECONDS COMMAND...: until it succeeds
wait_for() {
    local tenths=$((10 * $1))
    shift
    for _ in $(seq "$tenths"); do
        "$@" && return
        sleep 0.1
    done
    echo "waited in vain for: $*"
    return 1
}

# value_of STACK COLUMN in a batch.csv on stdin
value_of() {
    /usr/bin/python3 -c 'import csv, sys
print(next(row[sys.argv[2]] for row in csv.DictReader(sys.stdin) if row["stack"] == sys.argv[1]))' "$@"
}
