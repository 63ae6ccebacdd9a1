bats_require_minimum_version 1.5.0
load common

image_shapes() {
    "$TOMODEM_BIN/image_shapes" "$@"
}

against_skimage() {
    /usr/bin/python3 -c 'import skimage.measure, PIL' 2>/dev/null || skip "python3-skimage is not there"
    /usr/bin/python3 "$TOMODEM_SOURCE/tests/tools/metrics/against_skimage.py" "$@"
}

@test "inclusions of a phantom have the moments that scikit-image finds, and the truth" {
    "$TOMODEM_BIN/phantom_inclusions" phantom.tif --size 70 --voxel-size 2.4um --fraction 0.15 --count 6 --quiet
    image_shapes phantom.tif out.csv --objects 2 --min-voxels 1 --json out.json
    /usr/bin/python3 - <<'PYTHON'
import csv, json
rows = list(csv.DictReader(open("out.csv")))
grains = json.load(open("phantom.json"))["objects"]
assert len(rows) == len(grains) == 6
for row in rows:
    centre = [float(row[f"centre_{c} [mm]"]) for c in "xyz"]
    grain = min(grains, key=lambda g: sum((a - b) ** 2 for a, b in zip(g["centre_mm"], centre)))
    assert max(abs(a - b) for a, b in zip(grain["centre_mm"], centre)) < 1e-4, (row, grain)
    assert abs(float(row["semi_axis_a [mm]"]) / grain["radius_mm"] - 1) < 0.01
    assert abs(float(row["shape_factor [-]"]) - 1) < 0.01
    assert abs(float(row["sphericity [-]"]) - 1) < 0.01
PYTHON
    against_skimage out.csv 2.4e-3 --labels 2 phantom.tif
}

@test "the nodules of the cast iron have the moments that scikit-image finds" {
    data="${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/data/nodular_cast_iron/labels"
    [ -d "$data" ] || skip "the cast iron is not in $data"
    image_shapes "$data" out.csv --voxel-size 3um --roi 0:300,0:300,0:150 --objects 1 --connectivity 26 --min-voxels 8
    against_skimage out.csv 3e-3 --labels 1 --min-voxels 8 "$data"/slice_0??.tif "$data"/slice_1[0-4]?.tif
}

@test "closed pores are those of the phantom, and open ones are counted" {
    "$TOMODEM_BIN/phantom_pores" pores.tif --size 70 --voxel-size 2.4um --porosity 0.05 --median-diameter 50um --clusters 0 --quiet
    image_shapes pores.tif out.csv --pores --json out.json
    [ "$(value pores out.json)" -eq "$(/usr/bin/python3 -c 'import json; print(len(json.load(open("pores.json"))["objects"]))')" ]
    [ "$(value pores_open out.json)" -eq 0 ]
    close "$(value closed_porosity out.json)" 5 0.02
    while read -r sphericity; do close "$sphericity" 1 0.02; done < <(column "sphericity [-]" out.csv)
    image_shapes pores.tif cut.csv --pores --roi 0:70,0:70,0:35 --json cut.json
    [ "$(value pores_open cut.json)" -gt 0 ]
    [ "$(value pores cut.json)" -lt "$(value pores out.json)" ]
}

@test "numbers are those that vol2pack gives the objects of the sample" {
    "$TOMODEM_BIN/packgen" brick.h5 --particles 2000 --density 0.6 --quiet
    "$TOMODEM_BIN/phantom_inclusions" phantom.tif --size 60 --voxel-size 10um --fraction 0.2 --count 4 --quiet
    "$TOMODEM_BIN/vol2pack" brick.h5 phantom.tif sample.h5 --pixels-per-seed 1.5 --objects 2 --quiet 2>/dev/null
    "$TOMODEM_BIN/object_shapes" sample.h5 run.csv
    image_shapes phantom.tif out.csv --objects 2
    for place in 1 2 3 4; do
        [ "$(column "object [-]" out.csv | sed -n ${place}p)" = "$(column "object [-]" run.csv | sed -n ${place}p)" ]
        close "$(column "centre_x [mm]" out.csv | sed -n ${place}p)" "$(column "centre_x [mm]" run.csv | sed -n ${place}p)" 0.1
        close "$(column "centre_z [mm]" out.csv | sed -n ${place}p)" "$(column "centre_z [mm]" run.csv | sed -n ${place}p)" 0.1
    done
}

@test "the height is along the axis asked for" {
    /usr/bin/python3 -c '
import numpy as np
i = np.indices((40, 40, 80)) + 0.5 - np.array([20, 20, 40]).reshape(3, 1, 1, 1)
(((i / np.array([18, 18, 36]).reshape(3, 1, 1, 1)) ** 2).sum(axis=0) < 1).astype("u1").tofile("rod.raw")'
    raw=(rod.raw --raw-size 80x40x40 --raw-type uint8 --voxel-size 1um)
    image_shapes "${raw[0]}" x.csv "${raw[@]:1}" --objects 1 --axis x
    image_shapes "${raw[0]}" z.csv "${raw[@]:1}" --objects 1
    close "$(column "shape_factor [-]" x.csv)" 2 0.01
    close "$(column "shape_factor [-]" z.csv)" 0.6667 0.01
    close "$(column "direction_a_x [-]" z.csv)" 1 1e-6
}

@test "bad requests are refused with one line and no table" {
    /usr/bin/python3 -c '
import numpy as np
np.zeros((8, 8, 8), "u1").tofile("void.raw")
np.ones((8, 8, 8), "u1").tofile("solid.raw")'
    raw=(--raw-size 8 --raw-type uint8 --voxel-size 1um)
    fails 2 "say what to measure" image_shapes solid.raw out.csv "${raw[@]}"
    fails 1 "all of it is void" image_shapes void.raw out.csv "${raw[@]}" --objects 1
    fails 1 "all of it is void" image_shapes void.raw out.csv "${raw[@]}" --pores
    fails 1 "--objects 2: the image has no such label; it has 1" image_shapes solid.raw out.csv "${raw[@]}" --objects 2
    fails 1 "no label from 5 to 9" image_shapes solid.raw out.csv "${raw[@]}" --label-objects 5:9=1
    fails 1 "1 have fewer than --min-voxels 600" image_shapes solid.raw out.csv "${raw[@]}" --objects 1 --min-voxels 600
    fails 1 "1 touch a face" image_shapes solid.raw out.csv "${raw[@]}" --objects 1 --exclude-boundary
    fails 2 "exclude each other" image_shapes solid.raw out.csv "${raw[@]}" --objects 1 --pores
    fails 2 "--exclude-boundary belongs to objects" image_shapes solid.raw out.csv "${raw[@]}" --pores --exclude-boundary
    fails 1 "voxel" image_shapes solid.raw out.csv --raw-size 8 --raw-type uint8 --objects 1
    image_shapes solid.raw none.csv "${raw[@]}" --pores 2>warning
    grep -q "no closed pore" warning
    [ "$(wc -l <none.csv)" -eq 1 ]
}
