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

@test "each object has the displacement and rotation that it was given, in the table and for ParaView" {
    "$TOMODEM_BIN/packgen" brick.h5 --particles 3000 --density 0.64 --quiet
    PYTHONPATH="$TOMODEM_SOURCE/bench/metrics" /usr/bin/python3 - "$TOMODEM_BIN/object_shapes" <<'PYTHON'
import csv, json, subprocess, sys
import h5py, numpy as np
from ellipsoid_packing import ellipsoid, read_brick, write_objects
from scipy.spatial.transform import Rotation
brick, random = read_brick("brick.h5"), np.random.default_rng(5)
objects = [ellipsoid(brick, count, 0.6, random) for count in (300, 30, 100)]
objects.append(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]))  # in a row: too small for a shape, without a rotation
write_objects("run.h5", objects, brick[2])
angles = np.array([1e-4, 170.0, 25.0, 40.0])
turns = [Rotation.from_rotvec(np.radians(angle) * axis / np.linalg.norm(axis))
         for angle, axis in zip(angles, random.normal(size=(4, 3)))]
ways = random.normal(size=(4, 3))
with h5py.File("run.h5", "a") as file:
    position = file["particles/all/position"]
    first = position["value"][0]
    number = file["particles/all/object"][:]
    last = first.copy()
    for k in range(4):
        its, middle = number == k + 1, first[number == k + 1].mean(axis=0)
        last[its] = turns[k].apply(first[its] - middle) + middle + ways[k]
    for name in list(position):
        del position[name]
    position["value"], position["step"], position["time"] = np.stack([first, last]), [0, 1], [0.0, 1.0]
    curve = file.create_group("observables/strain")
    curve["value"], curve["step"], curve["time"] = [0.0, -0.1], [0, 1], [0.0, 1.0]
    curve.attrs["unit"] = ""
subprocess.run([sys.argv[1], "run.h5", "out.csv", "--fields", "motion.h5", "--json", "out.json", "--quiet"], check=True)
rows = [row for row in csv.DictReader(open("out.csv")) if row["frame [-]"] == "1"]
assert [row["object [-]"] for row in rows] == ["1", "2", "3"]
for k, row in enumerate(rows):
    way = [float(row[f"displacement_{c} [mm]"]) for c in "xyz"]
    turn = [float(row[f"rotation_{c} [degree]"]) for c in "xyz"]
    assert np.abs(way - ways[k]).max() < 1e-6, (way, ways[k])
    assert np.abs(turn - np.degrees(turns[k].as_rotvec())).max() < 1e-6, (turn, turns[k].as_rotvec())
    assert abs(float(row["rotation [degree]"]) - angles[k]) < 1e-6 and float(row["deformation_rms [mm]"]) < 1e-6
summary = json.load(open("out.json"))
assert abs(summary["displacement_last"] - np.linalg.norm(ways[:3], axis=1).mean()) < 1e-6
assert abs(summary["rotation_last"] - angles[:3].mean()) < 1e-6
with h5py.File("motion.h5") as file:
    way, turn = (file[f"particles/all/{name}/value"][-1] for name in ("object_displacement", "object_rotation"))
for k in range(4):
    its = number == k + 1
    assert np.abs(way[its] - ways[k]).max() < 1e-6
    if k < 3:
        assert np.abs(turn[its] - np.degrees(turns[k].as_rotvec())).max() < 1e-6
    else:
        assert np.isnan(turn[its]).all()
PYTHON
    grep -q object_rotation motion.xdmf
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
