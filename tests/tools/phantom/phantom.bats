# The phantoms, their truth, and what they refuse.

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_TMPDIR"
}

info() {
    "$TOMODEM_BIN/volume_info" "$1" --min-component 1 --json info.json --quiet
}

@test "phantom_inclusions has the fraction, the count and the separate inclusions of its truth" {
    "$TOMODEM_BIN/phantom_inclusions" a.tif --size 100 --voxel-size 2.4um --fraction 0.2 --count 20
    info a.tif
    /usr/bin/python3 - <<'PYTHON'
import json, math
info, truth = json.load(open("info.json")), json.load(open("a.json"))
assert truth["count"] == len(truth["objects"]) == info["components_label_2"] == 20
assert truth["size_voxels"] == [100, 100, 100] and abs(truth["voxel_size_mm"] - 0.0024) < 1e-15
for label in truth["labels"]:
    assert label["voxels"] == info[f"voxels_label_{label['label']}"]
    assert abs(label["voxel_fraction"] - label["analytic_fraction"]) < 0.002
for inclusion in truth["objects"]:
    assert math.isclose(inclusion["volume_mm3"], 4 / 3 * math.pi * inclusion["radius_mm"] ** 3, rel_tol=1e-9)
    assert math.isclose(inclusion["volume_voxels"], inclusion["voxels"], rel_tol=0.02)
    assert all(0 < x - inclusion["radius_mm"] and x + inclusion["radius_mm"] < 0.24 for x in inclusion["centre_mm"])
PYTHON
}

@test "phantom_pores has closed pores of the porosity, some of them no spheres" {
    "$TOMODEM_BIN/phantom_pores" a.tif --size 120x100x100 --voxel-size 10um --porosity 0.03 --median-diameter 100um \
        --clusters 0.4
    info a.tif
    /usr/bin/python3 - <<'PYTHON'
import json
info, truth = json.load(open("info.json")), json.load(open("a.json"))
assert info["components_label_0"] == truth["count"] and info["components_label_1"] == 1
assert abs(info["fraction_label_0"] - 3) < 0.1
assert 0 < sum(len(pore["spheres"]) > 1 for pore in truth["objects"]) < truth["count"]
assert sum(pore["voxels"] for pore in truth["objects"]) == info["voxels_label_0"]
PYTHON
}

@test "phantom_grains are whole, nearly all touch, and share voxels at the plane between them" {
    "$TOMODEM_BIN/phantom_grains" a.tif --size 90x80x70 --voxel-size 4um --fraction 0.5 --count 30 --objects b.tif
    info a.tif
    /usr/bin/python3 - <<'PYTHON'
import json, math
import numpy as np
from PIL import Image, ImageSequence
read = lambda path: np.array([np.array(page) for page in ImageSequence.Iterator(Image.open(path))])
info, truth, phase, number = json.load(open("info.json")), json.load(open("a.json")), read("a.tif"), read("b.tif")
assert truth["count"] == len(truth["objects"]) == number.max() == 30 and info["components_label_1"] < 8
assert ((number > 0) == (phase == 1)).all()
balls = [(np.array(ball["centre_voxels"]), ball["radius_voxels"]) for ball in truth["objects"]]
assert abs(sum(4 / 3 * math.pi * r**3 for _, r in balls) / phase.size - 0.5) < 1e-6
for (centre, radius), ball in zip(balls, truth["objects"]):
    assert (centre - radius > -1e-9).all() and (centre + radius < np.array([90, 80, 70]) + 1e-9).all()
    assert ball["voxels"] == (number == ball["number"]).sum() > 0.8 * ball["volume_voxels"]
gaps = [np.linalg.norm(a - b) / (r + s) for i, (a, r) in enumerate(balls) for b, s in balls[:i]]
assert min(gaps) > 0.9 - 1e-9 and sum(gap < 1 for gap in gaps) >= 30, (min(gaps), sum(gap < 1 for gap in gaps))
# Every voxel is the grain's whose sphere it lies deepest in, by the power of its centre.
z, y, x = np.indices(number.shape) + 0.5
power = np.array([(x - c[0])**2 + (y - c[1])**2 + (z - c[2])**2 - r * r for c, r in balls])
assert (number == np.where(power.min(axis=0) <= 0, power.argmin(axis=0) + 1, 0)).mean() > 1 - 1e-6
PYTHON
}

@test "phantom_foam has its relative density within 0.2 points, in one piece with one open pore space" {
    for density in 0.066 0.12 0.18; do
        "$TOMODEM_BIN/phantom_foam" a.tif --size 100 --voxel-size 20um --relative-density $density --cells 2
        info a.tif
        DENSITY=$density /usr/bin/python3 - <<'PYTHON'
import json, os
info, truth = json.load(open("info.json")), json.load(open("a.json"))
assert abs(info["fraction_label_1"] - 100 * float(os.environ["DENSITY"])) < 0.2
assert info["components_label_1"] == truth["solid_components"] == 1
assert info["largest_component_label_0"] > 0.999 * info["voxels_label_0"]
PYTHON
    done
}

@test "the same random seed gives the same bytes, another one another phantom" {
    for kind in "inclusions --fraction 0.2 --count 9" "pores --porosity 0.02 --median-diameter 15um" \
        "foam --relative-density 0.15 --cells 2" "fibres --relative-density 0.2" "grains --fraction 0.4 --count 9"; do
        set -- $kind
        tool=$TOMODEM_BIN/phantom_$1
        shift
        mkdir -p one two
        (cd one && "$tool" a.tif --size 60 --voxel-size 1um "$@" --quiet --threads 1)
        (cd two && "$tool" a.tif --size 60 --voxel-size 1um "$@" --quiet --threads 3)
        "$tool" other.tif --size 60 --voxel-size 1um "$@" --random-seed 7 --quiet
        cmp one/a.tif two/a.tif
        ! cmp -s one/a.tif other.tif
    done
}

@test "phantom_fibres has its relative density within 0.2 points, in one piece" {
    "$TOMODEM_BIN/phantom_fibres" a.tif --size 100 --voxel-size 4um --relative-density 0.15
    info a.tif
    /usr/bin/python3 - <<'PYTHON'
import json
info, truth = json.load(open("info.json")), json.load(open("a.json"))
assert abs(info["fraction_label_1"] - 15) < 0.2
assert info["components_label_1"] == truth["solid_components"] == 1
# 40 fibres through the cube, of which those that cross share voxels: the radius is at least that of separate ones.
assert truth["fibre_radius_voxels"] > (0.15 * 100**2 / (40 * 3.1416)) ** 0.5
PYTHON
}

@test "phantom_scan gives each label its grey value, and noise and shading of the size asked for" {
    "$TOMODEM_BIN/phantom_foam" labels.tif --size 60 --voxel-size 7um --relative-density 0.2 --cells 1
    "$TOMODEM_BIN/phantom_scan" labels.tif plain.tif --grey 60,180 --noise 0
    "$TOMODEM_BIN/phantom_scan" labels.tif noisy.tif --grey 60,180 --noise 12
    "$TOMODEM_BIN/phantom_scan" labels.tif shaded.tif --grey 60,180 --noise 0 --shading 0.5
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from PIL import Image, ImageSequence
labels, plain, noisy, shaded = (np.array([np.array(page) for page in ImageSequence.Iterator(Image.open(f"{name}.tif"))])
                                for name in ("labels", "plain", "noisy", "shaded"))
assert (plain == np.where(labels == 1, 180, 60)).all()
noise = noisy.astype(float) - plain
assert abs(noise.std() - 12) < 0.2 and abs(noise.mean()) < 0.2, (noise.std(), noise.mean())
assert (shaded[:, :, 0] == plain[:, :, 0]).all() and (shaded[:, :, -1] == plain[:, :, -1] // 2).all()
PYTHON
    # The voxel size goes with it, and Otsu's threshold finds the labels again.
    "$TOMODEM_BIN/volume_info" plain.tif --otsu 1 --json scan.json --quiet
    "$TOMODEM_BIN/volume_info" labels.tif --json labels.json --quiet
    /usr/bin/python3 -c 'import json
scan, labels = json.load(open("scan.json")), json.load(open("labels.json"))
assert scan["voxels_label_1"] == labels["voxels_label_1"] and scan["voxel_size_x"] == labels["voxel_size_x"] == 7, scan'
}

@test "--truth names the file of the truth" {
    "$TOMODEM_BIN/phantom_foam" a.tif --size 40 --voxel-size 1um --relative-density 0.2 --cells 1 --truth known.json
    [ -e known.json ]
    [ ! -e a.json ]
}

# refused STATUS TEXT COMMAND...: one line on stderr, this exit status, no file.
refused() {
    local wanted_status=$1 text=$2
    shift 2
    run --separate-stderr "$@"
    echo "status $status: $stderr"
    [ "$status" -eq "$wanted_status" ]
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == *"$text"* ]]
    [ -z "$(find . -name '*a.*')" ]
}

@test "refuses what cannot be made, without a file" {
    refused 1 "do not fit" "$TOMODEM_BIN/phantom_inclusions" a.tif --size 40 --voxel-size 1um --fraction 0.7 --count 30 --quiet
    refused 2 "two of" "$TOMODEM_BIN/phantom_inclusions" a.tif --voxel-size 1um --fraction 0.2
    refused 2 "--diameter" "$TOMODEM_BIN/phantom_inclusions" a.tif --voxel-size 1um --count 3 --diameter 5
    refused 2 "--size" "$TOMODEM_BIN/phantom_inclusions" a.tif --size 10x10 --voxel-size 1um --count 3 --diameter 5um
    refused 1 "do not hold together" "$TOMODEM_BIN/phantom_foam" a.tif --size 40 --voxel-size 1um --relative-density 0.01 \
        --cells 4 --quiet
    # Fibres in planes meet only those at their own height.
    refused 1 "do not hold together" "$TOMODEM_BIN/phantom_fibres" a.tif --size 60 --voxel-size 4um --relative-density 0.1 \
        --fibres 6 --out-of-plane 0 --quiet
    "$TOMODEM_BIN/phantom_inclusions" two.tif --size 20 --voxel-size 1um --count 1 --diameter 9um --quiet
    refused 1 "label 2 of the volume has no grey value" "$TOMODEM_BIN/phantom_scan" two.tif a.tif --grey 60,180
    refused 2 "--grey" "$TOMODEM_BIN/phantom_scan" two.tif a.tif --grey 60,high
    refused 2 "--grey" "$TOMODEM_BIN/phantom_scan" two.tif a.tif --grey 60,180,nan
    refused 2 "--grey" "$TOMODEM_BIN/phantom_scan" two.tif a.tif --grey 60,180,256
    refused 2 "must end in .tif" "$TOMODEM_BIN/phantom_foam" a.json --voxel-size 1um --relative-density 0.1
}
