# vol2pack with volumes, folders and disks at the edge of what there is: one clear line, or a right result.
load common

# volume FILE EXPRESSION: a [z][y][x] array by numpy.
volume() {
    PYTHONPATH="$BATS_TEST_DIRNAME" /usr/bin/python3 -c "
import sys
import numpy as np
from write_tiff import write_tiff
write_tiff(sys.argv[1], $2)" "$1"
}

# value KEY: of out.json
value() { /usr/bin/python3 -c "import json, sys; print(json.load(open('out.json'))[sys.argv[1]])" "$1"; }

@test "all void" {
    volume void.tif 'np.zeros((20, 20, 20))'
    refused 1 "no particle is left: all of them lie in void (label 0); check the labels or the threshold" \
        vol2pack brick.h5 void.tif out.h5 --voxel-size 10um --pixels-per-seed 2
    refused 1 "no particle is left" vol2pack brick.h5 void.tif out.h5 --voxel-size 10um --max-error 5% --quiet
}

@test "all solid" {
    volume solid.tif 'np.ones((40, 40, 40))'
    vol2pack brick.h5 solid.tif out.h5 --voxel-size 10um --pixels-per-seed 2 --json out.json
    [ "$(value volume_error)" = 0.0 ]
    [ "$(value components_label_1)" = 1 ]
    # 0.7 of the volume, within what the faces cut.
    /usr/bin/python3 -c 'import json; n = json.load(open("out.json"))["particles"]; assert abs(n * 33.51 / 64000 / 0.7 - 1) < 0.03, n'
}

@test "one voxel" {
    volume one.tif 'np.ones((1, 1, 1))'
    refused 1 "the image is smaller than a particle; use fewer pixels per seed" \
        vol2pack brick.h5 one.tif out.h5 --voxel-size 10um --pixels-per-seed 30
    vol2pack brick.h5 one.tif out.h5 --voxel-size 10um --pixels-per-seed 0.05 --json out.json
    [ "$(value volume_error)" = 0.0 ]
}

@test "a line of voxels, along each axis" {
    for shape in '1, 1, 30' '1, 30, 1' '30, 1, 1'; do
        volume line.tif "1 + (np.arange(30) >= 10).reshape($shape)"
        vol2pack brick.h5 line.tif out.h5 --voxel-size 10um --pixels-per-seed 0.1 --random-seed 1 --json out.json
        /usr/bin/python3 - <<'PYTHON'
import json
report = json.load(open("out.json"))
assert [phase["voxels"] for phase in report["phases"]] == [0, 10, 20]
assert report["volume_error"] < 2, report["volume_error"]
# One section of one voxel.
assert abs(report["image_surface_label_1"] / 1e-4 - 1) < 0.1, report["image_surface_label_1"]
assert abs(report["sample_surface_label_1"] / 1e-4 - 1) < 0.2, report["sample_surface_label_1"]
PYTHON
    done
}

@test "voxels of 1 to 20, either way" {
    # The same half-filled millimetre in flat and in tall voxels.
    volume flat.tif '1 + (np.arange(80) >= 40).reshape(1, 1, 80) + np.zeros((4, 80, 1))'
    volume tall.tif '1 + (np.arange(4) >= 2).reshape(1, 1, 4) + np.zeros((80, 4, 1))'
    vol2pack brick.h5 flat.tif out.h5 --voxel-size 10um --slice-spacing 200um --pixels-per-seed 3 --json out.json
    cp out.json flat.json
    # A pixel is an edge along x: the same particles.
    vol2pack brick.h5 tall.tif out.h5 --voxel-size 200um --slice-spacing 10um --pixels-per-seed 0.15 --json out.json
    /usr/bin/python3 - <<'PYTHON'
import json
flat, tall = (json.load(open(name)) for name in ("flat.json", "out.json"))
assert flat["particles"] == tall["particles"] > 3000
for report in flat, tall:
    assert report["volume_error"] < 3, report["volume_error"]
    assert abs(report["sample_surface_label_1"] / 0.64 - 1) < 0.1, report["sample_surface_label_1"]
    assert abs(report["image_surface_label_1"] / 0.64 - 1) < 0.2, report["image_surface_label_1"]
PYTHON
}

@test "labels above 65,535" {
    volume large.tif 'np.where(np.arange(40).reshape(1, 1, 40) < 20, 70000, 2000000000) + np.zeros((40, 40, 1))'
    vol2pack brick.h5 large.tif out.h5 --voxel-size 10um --pixels-per-seed 2 --labels 70000=a,2000000000=b --json out.json
    [ "$(/usr/bin/python3 -c 'import h5py; print(*sorted(set(h5py.File("out.h5")["particles/all/species"][:])))')" = \
        "70000 2000000000" ]
    # 4294967295 as signed is -1, which no sample can have.
    volume negative.tif 'np.full((8, 8, 8), 4294967295)'
    run vol2pack brick.h5 negative.tif none.h5 --voxel-size 10um --pixels-per-seed 2
    [ "$status" -eq 1 ]
    [ "${#lines[@]}" -eq 1 ]
    [ ! -e none.h5 ]
}

@test "grains of a label image become objects of one phase" {
    volume grains.tif '(np.arange(48) // 12 + 2).reshape(1, 1, 48) + np.zeros((24, 24, 1))'
    vol2pack brick.h5 grains.tif out.h5 --voxel-size 10um --pixels-per-seed 1.5 --label-objects 2:5=1 --json out.json
    /usr/bin/python3 - <<'PYTHON'
import h5py, json
particles = h5py.File("out.h5")["particles/all"]
assert set(particles["species"][:]) == {1}
assert set(particles["object"][:]) == {2, 3, 4, 5}
x = particles["position/value"][0][:, 0]
assert abs(x // 0.12 + 2 - particles["object"][:]).max() == 0
assert json.load(open("out.json"))["object_numbers"] == [2, 3, 4, 5]
PYTHON
    rm out.h5
    refused 1 "no label from 7 to 9" vol2pack brick.h5 grains.tif none.h5 --voxel-size 10um --pixels-per-seed 1.5 \
        --label-objects 7:9=1
}

@test "the resolution is asked for once" {
    volume solid.tif 'np.ones((8, 8, 8))'
    refused 2 "give the resolution: --pixels-per-seed, or --max-error" vol2pack brick.h5 solid.tif out.h5 --voxel-size 10um
    refused 2 "--max-error" vol2pack brick.h5 solid.tif out.h5 --voxel-size 10um --pixels-per-seed 2 --max-error 2%
    refused 2 "--smoothing belongs to --filter level-set" vol2pack brick.h5 solid.tif out.h5 --voxel-size 10um \
        --pixels-per-seed 2 --filter nearest --smoothing 1
}

@test "--max-error is kept by the sample, for every random seed, and said where it cannot be" {
    volume ball.tif '1 + (sum((a - 29.5) ** 2 for a in np.mgrid[:60, :60, :60]) < 20 ** 2)'
    for seed in 0 1 2; do
        vol2pack brick.h5 ball.tif out.h5 --voxel-size 10um --max-error 3% --random-seed $seed --json out.json
        /usr/bin/python3 - <<'PYTHON'
import h5py, json
report = json.load(open("out.json"))
assert report["volume_error"] <= report["chosen_for_error"] <= 3
tried = report["resolutions_tried"]
assert tried[-1]["pixels_per_seed"] == report["pixels_per_seed"] > 1
assert all(step["error"] > 0.03 for step in tried[:-1]) and tried[-1]["error"] <= 0.03
stated = json.loads(h5py.File("out.h5")["parameters/tomodem/geometric_error"][()])
assert stated == report["geometric_error"]
assert abs(100 * max(abs(row["volume_error"]) for row in stated) - report["volume_error"]) < 1e-9
PYTHON
    done
    rm out.h5
    refused 1 "no resolution keeps the volume of every label within 0.001 %" vol2pack brick.h5 ball.tif out.h5 \
        --voxel-size 10um --max-error 0.001%
    refused 1 "more than the 2000 allowed" vol2pack brick.h5 ball.tif out.h5 --voxel-size 10um --max-error 0.2% \
        --max-particles 2000
}

@test "a read-only folder" {
    volume solid.tif 'np.ones((8, 8, 8))'
    mkdir closed
    if [ "$(id -u)" = 0 ]; then
        mount -t tmpfs -o ro tmpfs closed 2>/dev/null || skip "root writes anywhere, and mounting a tmpfs is not allowed"
    else
        chmod a-w closed
    fi
    run --separate-stderr vol2pack brick.h5 solid.tif closed/out.h5 --voxel-size 10um --pixels-per-seed 1
    if [ "$(id -u)" = 0 ]; then umount closed; fi
    echo "$stderr"
    [ "$status" -eq 1 ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == *"closed"* ]]
}

@test "a full disk leaves no file, and the previous one untouched" {
    if ! mkdir small || ! mount -t tmpfs -o size=64k tmpfs small 2>/dev/null; then skip "mounting a small tmpfs needs root"; fi
    volume solid.tif 'np.ones((40, 40, 40))'
    echo previous > small/out.h5
    code=0
    vol2pack brick.h5 solid.tif small/out.h5 --voxel-size 10um --pixels-per-seed 1 --quiet 2>err.txt || code=$?
    left=$(ls -A small)
    content=$(cat small/out.h5)
    umount small
    cat err.txt
    [ "$code" = 1 ]
    [ "$(wc -l <err.txt)" = 1 ]
    [ "$left" = out.h5 ]
    [ "$content" = previous ]
}
