bats_require_minimum_version 1.5.0
load common

object_shapes() {
    "$TOMODEM_BIN/object_shapes" "$@"
}

@test "S_f of ellipsoids of 2,000 particles cut out of a random packing is right to 1 %" {
    "$TOMODEM_BIN/packgen" brick.h5 --particles 3000 --density 0.64 --quiet
    PYTHONPATH="$TOMODEM_SOURCE/bench/metrics" /usr/bin/python3 - "$TOMODEM_BIN/object_shapes" <<'PYTHON'
import csv, subprocess, sys
import numpy as np
from ellipsoid_packing import ellipsoid, read_brick, write_objects
brick, random = read_brick("brick.h5"), np.random.default_rng(3)
for factor in (0.3, 0.6, 1.0, 3.0):
    write_objects("objects.h5", [ellipsoid(brick, 2000, factor, random) for _ in range(12)], brick[2])
    subprocess.run([sys.argv[1], "objects.h5", "out.csv", "--quiet"], check=True)
    rows = list(csv.DictReader(open("out.csv")))
    error = np.array([float(row["shape_factor [-]"]) for row in rows]) / factor - 1
    print(factor, "bias", error.mean(), "deviation", error.std())
    assert len(rows) == 12 and abs(error.mean()) < 0.005 and np.sqrt((error**2).mean()) < 0.01, error
    # The volume of the ellipsoid's particles: 2,000 on average.
    width = (0.75 * 2000 * brick[1].prod() / 3000 / np.pi / factor) ** (1 / 3)
    volume = np.array([float(row["volume [mm^3]"]) for row in rows]) / (4 / 3 * np.pi * factor * width**3) - 1
    assert abs(volume.mean()) < 0.015, volume
# All particles of a packing that is one object: its share of the volume is the box.
write_objects("objects.h5", [brick[0]], brick[2])
subprocess.run([sys.argv[1], "objects.h5", "out.csv", "--quiet"], check=True)
row, = csv.DictReader(open("out.csv"))
assert row["volume_share [-]"] == "inside"
assert abs(float(row["volume [mm^3]"]) / brick[1].prod() - 1) < 0.01, row
# Turned at random, the axes of the ellipsoid itself are still those.
write_objects("objects.h5", [ellipsoid(brick, 2000, 3.0, random, turned=True) for _ in range(12)], brick[2])
subprocess.run([sys.argv[1], "objects.h5", "out.csv", "--quiet"], check=True)
for row in csv.DictReader(open("out.csv")):
    a, b, c = (float(row[f"semi_axis_{axis} [mm]"]) for axis in "abc")
    assert abs(a / (0.5 * (b + c)) / 3 - 1) < 0.02, row
PYTHON
}

@test "S_f is that of shape_factor, for the same objects" {
    "$synthetic_run" run.h5 objects=1 cells=14 strain=0.3 frames=3
    object_shapes run.h5 out.csv --json out.json
    "$TOMODEM_BIN/shape_factor" run.h5 factors.csv
    [ "$(column "shape_factor [-]" out.csv)" = "$(column "shape_factor [-]" factors.csv)" ]
    [ "$(column "shape_factor_normalised [-]" out.csv)" = "$(column "shape_factor_normalised [-]" factors.csv)" ]
    [ "$(column "object [-]" out.csv | tr '\n' ' ')" = "1 2 1 2 1 2 " ]
    [ "$(column "at_boundary [-]" out.csv | tr '\n' ' ')" = "0 1 0 1 0 1 " ]
    [ "$(/usr/bin/python3 -c 'import json; print(len(json.load(open("out.json"))["shapes"]))')" -eq 6 ]
}

@test "a sphere pressed flat has the axes of the flat ellipsoid, which go on from frame to frame" {
    "$synthetic_run" run.h5 objects=1 cells=14 strain=0.3 frames=7
    object_shapes run.h5 out.csv --exclude-boundary
    /usr/bin/python3 - <<'PYTHON'
import csv, math
import numpy as np
rows = list(csv.DictReader(open("out.csv")))
assert len(rows) == 7
before = None
for row in rows:
    strain = float(row["strain [-]"])
    axes = [float(row[f"semi_axis_{a} [mm]"]) for a in "abc"]
    assert abs(axes[2] / (4 * math.exp(strain)) - 1) < 0.02, row
    assert abs(axes[0] / (4 * math.exp(-strain / 2)) - 1) < 0.02, row
    turned = np.array([[float(row[f"direction_{a}_{c} [-]"]) for c in "xyz"] for a in "abc"])
    tracked = np.array([turned[row["follows [-]"].index(a)] for a in "abc"])
    if before is not None:
        assert (tracked * before).sum(axis=1).min() > 0, row
    before = tracked
    assert sorted(row["follows [-]"]) == ["a", "b", "c"]
    if strain < -0.1:
        assert abs(turned[2][2]) > 0.99
PYTHON
}

@test "frames are chosen, and the table is the same on one thread and two" {
    "$synthetic_run" run.h5 objects=1 cells=14 frames=3
    object_shapes run.h5 all.csv --threads 1
    object_shapes run.h5 again.csv --threads 2
    cmp all.csv again.csv
    object_shapes run.h5 last.csv --frames last
    [ "$(column "frame [-]" last.csv | tr '\n' ' ')" = "2 2 " ]
    close "$(column "semi_axis_a [mm]" last.csv | head -1)" "$(column "semi_axis_a [mm]" all.csv | sed -n 5p)" 1e-9
}

@test "bad requests are refused with one line and no table" {
    "$synthetic_run" plain.h5
    "$synthetic_run" run.h5 objects=1 cells=14
    fails 1 "the sample has no objects" object_shapes plain.h5 out.csv
    fails 1 "frames 0 to 3" object_shapes run.h5 out.csv --frames 9
    fails 2 "give all, first, last" object_shapes run.h5 out.csv --frames some
    fails 1 "none of the 3 objects can be measured" object_shapes run.h5 out.csv --min-particles 1e6
    fails 2 "--min-particles" object_shapes run.h5 out.csv --min-particles 3
    # Two particles; all in a plane.
    PYTHONPATH="$TOMODEM_SOURCE/bench/metrics" /usr/bin/python3 -c '
import numpy as np
from ellipsoid_packing import write_objects
write_objects("two.h5", [np.array([[0.0, 0, 0], [1, 1, 1]])], 0.5)
write_objects("flat.h5", [np.array([[x, y, x + y] for x in range(9) for y in range(9)], float)], 0.5)'
    fails 1 "1 are too small or flat (the largest has 2 particles" object_shapes two.h5 out.csv
    fails 1 "none of the 1 objects can be measured" object_shapes flat.h5 out.csv
}
