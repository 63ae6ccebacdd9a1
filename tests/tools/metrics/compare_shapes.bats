bats_require_minimum_version 1.5.0
load common

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    "$TOMODEM_BIN/packgen" brick.h5 --particles 3000 --density 0.64 --quiet
    "$TOMODEM_BIN/phantom_inclusions" phantom.tif --size 80 --voxel-size 10um --fraction 0.2 --count 4 --quiet
    "$TOMODEM_BIN/vol2pack" brick.h5 phantom.tif sample.h5 --pixels-per-seed 2 --objects 2 --quiet 2>/dev/null
}

setup() {
    cd "$BATS_TEST_TMPDIR"
    cp "$BATS_FILE_TMPDIR"/{phantom.tif,sample.h5} .
}

compare_shapes() {
    "$TOMODEM_BIN/compare_shapes" "$@"
}

# below VALUE BOUND: |VALUE| < BOUND
below() {
    /usr/bin/python3 -c 'import sys; a, b = map(float, sys.argv[1:]); sys.exit(f"{a} is not below {b}" if not abs(a) < b else 0)' "$@"
}

@test "a sample and the image that it was made from differ by the resolution only" {
    compare_shapes sample.h5 phantom.tif out.csv --objects 2 --json out.json
    [ "$(column "match [-]" out.csv | tr '\n' ' ')" = "overlap overlap overlap overlap " ]
    [ "$(column "object_run [-]" out.csv)" = "$(column "object_image [-]" out.csv)" ]
    below "$(value mean_abs_shape_factor_difference out.json)" 0.02
    below "$(value volume_difference out.json)" 2
    below "$(value mean_distance out.json)" 0.005
    close "$(value mean_dice out.json)" 0.95 0.04
    close "$(value dice_label_2 out.json)" 0.95 0.04
    close "$(value dice_label_1 out.json)" 0.98 0.02
    [ "$(value closed_porosity_image out.json)" = 0.0 ]
    /usr/bin/python3 -c '
import json
summary = json.load(open("out.json"))
assert len(summary["pairs"]) == 4 and {"label", "dice", "iou", "fraction_run", "fraction_image"} == set(summary["phases"][0])'
}

@test "a sample moved, turned into a run and pressed is found again where it is known to be" {
    # Frame 1 is moved by (30, -20, 10) um; frame 2 is pressed to a true strain of -0.2 about the centre of the particles.
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
with h5py.File("sample.h5") as sample, h5py.File("run.h5", "w") as run:
    for name in ("h5md", "particles", "parameters"):
        sample.copy(name, run)
    frames = run["particles/all/position"]
    first = frames["value"][0]
    middle = first.mean(axis=0)
    pressed = middle + (first - middle) * np.exp([0.1, 0.1, -0.2])
    for name in list(frames):
        del frames[name]
    frames["value"] = np.stack([first, first + np.array([0.03, -0.02, 0.01]), pressed])
    frames["step"], frames["time"] = [0, 1, 2], [0.0, 1.0, 2.0]
    curve = run.create_group("observables/strain")
    curve["value"], curve["step"], curve["time"] = [0.0, 0.0, -0.2], [0, 1, 2], [0.0, 1.0, 2.0]
    curve.attrs["unit"] = ""
PYTHON
    compare_shapes run.h5 phantom.tif same.csv --frame 0 --objects 2 --json same.json
    compare_shapes run.h5 phantom.tif moved.csv --frame 1 --objects 2 --json moved.json
    compare_shapes run.h5 phantom.tif aligned.csv --frame 1 --objects 2 --align centre --json aligned.json
    compare_shapes run.h5 phantom.tif pressed.csv --objects 2 --json pressed.json
    compare_shapes run.h5 phantom.tif last.csv --frame last --objects 2
    cmp last.csv pressed.csv
    compare_shapes run.h5 phantom.tif first.csv --frame first --objects 2
    cmp first.csv same.csv
    /usr/bin/python3 - <<'PYTHON'
import csv, json, math
table = {n: list(csv.DictReader(open(f"{n}.csv"))) for n in ("same", "moved", "aligned", "pressed")}
summary = {n: json.load(open(f"{n}.json")) for n in table}
for same, moved, aligned, pressed in zip(*table.values()):
    for c, way in zip("xyz", (0.03, -0.02, 0.01)):
        key = f"difference_{c} [mm]"
        assert abs(float(moved[key]) - float(same[key]) - way) < 1e-9
        shift = summary["aligned"][f"run_moved_{c}"]
        assert abs(float(aligned[key]) - float(same[key]) - way - shift) < 1e-9
        assert abs(shift + way) < 0.003
    for key in ("shape_factor_run [-]", "semi_axis_a_run [mm]", "volume_run [mm^3]"):
        assert abs(float(moved[key]) / float(same[key]) - 1) < 1e-9
    ratio = float(pressed["shape_factor_run [-]"]) / float(same["shape_factor_run [-]"])
    assert abs(ratio - math.exp(-0.3)) < 1e-9, ratio
    difference = float(pressed["shape_factor_difference [-]"])
    assert abs(difference - float(pressed["shape_factor_run [-]"]) + float(pressed["shape_factor_image [-]"])) < 1e-9
assert summary["same"]["mean_dice"] > summary["moved"]["mean_dice"]
assert abs(summary["aligned"]["mean_dice"] - summary["same"]["mean_dice"]) < 0.02
assert summary["pressed"]["frame"] == 2 and abs(summary["pressed"]["strain"] + 0.2) < 1e-12
assert abs(summary["pressed"]["mean_shape_factor_difference"] - (math.exp(-0.3) - 1)) < 0.03
PYTHON
}

@test "what one side alone has is listed, and the order of the threads changes nothing" {
    compare_shapes sample.h5 phantom.tif out.csv --objects 2 --roi 0:80,0:80,0:30 --threads 1 --json out.json
    compare_shapes sample.h5 phantom.tif again.csv --objects 2 --roi 0:80,0:80,0:30 --threads 2
    cmp out.csv again.csv
    [ "$(value objects_matched out.json)" -lt 4 ]
    [ $(("$(value objects_matched out.json)" + "$(value objects_run_only out.json)")) -eq 4 ]
    grep -q "^run_only,4,,2,," out.csv
}

@test "closed pores of a sample without objects are found in its voxels" {
    "$TOMODEM_BIN/phantom_pores" pores.tif --size 80 --voxel-size 10um --porosity 0.05 --median-diameter 260um --spread 0 --clusters 0 --quiet
    "$TOMODEM_BIN/vol2pack" "$BATS_FILE_TMPDIR/brick.h5" pores.tif porous.h5 --pixels-per-seed 2 --quiet 2>/dev/null
    compare_shapes porous.h5 pores.tif out.csv --pores --json out.json
    [ "$(value objects_matched out.json)" -eq "$(/usr/bin/python3 -c 'import json; print(json.load(open("pores.json"))["count"])')" ]
    [ "$(value objects_run_only out.json)" -eq 0 ]
    close "$(value closed_porosity_run out.json)" "$(value closed_porosity_image out.json)" 0.05
    below "$(value mean_abs_shape_factor_difference out.json)" 0.05
    close "$(value mean_dice out.json)" 0.95 0.05
}

@test "bad requests are refused with one line and no table" {
    "$synthetic_run" plain.h5
    /usr/bin/python3 -c '
import numpy as np
np.zeros((80, 80, 80), "u1").tofile("void.raw")'
    fails 2 "say what to compare" compare_shapes sample.h5 phantom.tif out.csv
    fails 2 "exclude each other" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --pores
    fails 2 "--exclude-boundary belongs to objects" compare_shapes sample.h5 phantom.tif out.csv --pores --exclude-boundary
    fails 2 "--min-particles belongs to objects" compare_shapes sample.h5 phantom.tif out.csv --pores --min-particles 9
    fails 1 "--frame 3: the file has frames 0 to 0" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --frame 3
    fails 1 "has no objects" compare_shapes plain.h5 phantom.tif out.csv --objects 2
    fails 1 "--objects 5: the image has no such label" compare_shapes sample.h5 phantom.tif out.csv --objects 5
    fails 1 "check --voxel-size" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --bin 2 --roi 0:40,0:40,0:40
    fails 1 "give --align centre, or --origin" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --origin 5mm,0mm,0mm
    fails 1 "void" compare_shapes sample.h5 void.raw out.csv --raw-size 80 --raw-type uint8 --voxel-size 10um --objects 2
    fails 1 "void" compare_shapes sample.h5 void.raw out.csv --raw-size 80 --raw-type uint8 --voxel-size 10um --objects 2 --align centre
    fails 1 "none of the 4 objects" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --min-particles 1e6
    fails 1 "--min-voxels" compare_shapes sample.h5 phantom.tif out.csv --objects 2 --min-voxels 1e6
    compare_shapes sample.h5 phantom.tif far.csv --objects 2 --origin 5mm,0mm,0mm --align centre
}
