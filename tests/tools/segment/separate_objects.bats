#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# separate_objects as a user runs it.

setup() {
    cd "$BATS_TEST_TMPDIR" || return 1
    PATH=$TOMODEM_BIN:$PATH
    here=$TOMODEM_SOURCE/tests/tools/segment
    shared=$TOMODEM_SOURCE/../shared
    export PYTHONPATH=$here
}

value() { /usr/bin/python3 -c 'import json,sys; print(json.load(open(sys.argv[1]))[sys.argv[2]])' "$1" "$2"; }

@test "touching balls are as many objects as there are balls, of their volumes" {
    phantom_grains balls.tif --size 90 --voxel-size 4um --fraction 0.5 --diameter 64um:100um --objects truth.tif
    separate_objects balls.tif objects.tif --json found.json --picture objects.png --threads 2
    /usr/bin/python3 - <<'PYTHON'
import json
import numpy as np
from voxels import adjusted_rand_index, read
truth, found = json.load(open("balls.json")), json.load(open("found.json"))
true, objects = read("truth.tif"), read("objects.tif")
print(found["components"], found["components_cut"], found["objects"], truth["count"], found["touching_objects"])
assert truth["count"] >= 40 and found["components"] < truth["count"] / 4
assert found["objects"] == truth["count"] == found["touching_objects"]
assert found["label_objects"] == f"1:{truth['count']}=1"
assert ((objects > 0) == (true > 0)).all()
index = adjusted_rand_index(objects[true > 0].astype(int), true[true > 0].astype(int))
errors = []
for ball in truth["objects"]:
    x, y, z = (int(c) for c in ball["centre_voxels"])
    errors.append((objects == objects[z, y, x]).sum() / ball["voxels"] - 1)
print("Rand", index, "volume errors", np.abs(errors).max(), np.mean(errors))
assert index > 0.98
assert np.abs(errors).max() < 0.05
from PIL import Image
picture = np.array(Image.open("objects.png").convert("RGB"))
right = picture[:, picture.shape[1] // 2:]
assert len(np.unique(right.reshape(-1, 3), axis=0)) > 20
PYTHON
}

@test "the same parts as scikit-image's watershed: balls, longer voxels, real sand" {
    phantom_grains balls.tif --size 70x60x50 --voxel-size 4um --fraction 0.5 --count 25 --random-seed 4
    separate_objects balls.tif objects.tif --min-depth 2um
    "$here/against_skimage.py" balls.tif 1 objects.tif 1 0.5
    separate_objects balls.tif objects.tif --voxel-size 4um --slice-spacing 6um --override-voxel-size --min-depth 4um
    "$here/against_skimage.py" balls.tif 1 objects.tif 1 1 1.5
    [ -d "$shared/data" ] || skip "the shared tomographies are not at $shared/data"
    sand() { separate_objects "$shared/data/sand_pack/sand_labels.mhd" objects.tif --voxel-size 5um --labels 1 \
        --roi 120:190,80:150,25:75 --json sand.json "$@"; }
    /usr/bin/python3 - "$shared/data/sand_pack/sand_labels_200x200x100_uint8.raw" <<'PYTHON'
import sys
import numpy as np
from voxels import write
write("sand.tif", np.fromfile(sys.argv[1], np.uint8).reshape(100, 200, 200)[25:75, 80:150, 120:190])
PYTHON
    sand
    "$here/against_skimage.py" sand.tif 1 objects.tif 3 1
    sand --min-depth 10um
    "$here/against_skimage.py" sand.tif 1 objects.tif 3 2
    # The labels that were not named are as they were, and the objects come after them.
    /usr/bin/python3 - <<'PYTHON'
import json
from voxels import read
before, after, found = read("sand.tif"), read("objects.tif"), json.load(open("sand.json"))
assert ((after == 2) == (before == 2)).all() and (before == 2).any() and ((after == 0) == (before == 0)).all()
assert found["label_objects"] == f"3:{after.max()}=1" and after.max() == found["objects"] + 2
PYTHON
}

@test "vol2pack takes the objects as they are printed, and a range whose end the image has not" {
    phantom_grains balls.tif --size 50 --voxel-size 10um --fraction 0.4 --count 12
    separate_objects balls.tif objects.tif --json found.json --quiet
    packgen brick.h5 --particles 500 --density 0.7 --quiet
    for range in "$(value found.json label_objects)" 1:65535=1 1:2147483647=1; do
        vol2pack brick.h5 objects.tif sample.h5 --pixels-per-seed 2 --label-objects "$range" --labels 1=grain --json sample.json --quiet
        [ "$(value sample.json objects)" -eq 12 ]
    done
    # Without it the balls that touch are one object, and a warning says what to do.
    /usr/bin/python3 -c '
from voxels import read, write
image = read("balls.tif"); image[:3, :3, :3] = 1; write("balls.tif", image)'
    run -0 --separate-stderr vol2pack brick.h5 balls.tif sample.h5 --voxel-size 10um --pixels-per-seed 2 --objects 1 --quiet
    echo "$stderr"
    [[ "$stderr" == *"% of it: objects that touch are one; separate_objects gives each a label of its own"* ]]
    # The voxel size and place went along.
    volume_info objects.tif | grep -q "voxels of 10 x 10 x 10 um, from the file"
}

@test "small parts join the object beside them, specks take the label around them" {
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import write
image = np.zeros((40, 40, 70), np.uint8)
z, y, x = np.mgrid[:40, :40, :70]
ball = lambda cx, r: (x - cx) ** 2 + (y - 20) ** 2 + (z - 20) ** 2 <= r * r
image[ball(20, 14)] = 1
image[ball(38, 5)] = 1                      # touches the large one: a part of fewer than 600 voxels
image[3:6, 3:6, 60:63] = 1                  # alone
image[30:, 30:, 55:] = 2
image[34, 34, 60] = 1                       # alone, within label 2
write("a.tif", image)
PYTHON
    separate_objects a.tif all.tif --voxel-size 1um --labels 1 --json all.json
    [ "$(value all.json objects)" -eq 4 ]
    separate_objects a.tif large.tif --voxel-size 1um --labels 1 --min-voxels 600 --json large.json
    [ "$(value large.json objects)" -eq 1 ]
    [ "$(value large.json small_parts_joined)" -eq 1 ]
    [ "$(value large.json small_parts_removed)" -eq 2 ]
    /usr/bin/python3 - <<'PYTHON'
from voxels import read
before, after = read("a.tif"), read("large.tif")
assert after[20, 20, 20] == after[20, 20, 38] == 3
assert after[4, 4, 61] == 0 and after[34, 34, 60] == 2
assert (after == 3).sum() == (before == 1).sum() - 28
PYTHON
    run -1 --separate-stderr separate_objects a.tif none.tif --voxel-size 1um --labels 1 --min-voxels 100000
    [[ "$stderr" == *"nothing is left of label 1"*"smaller --min-voxels"* ]]
    [ ! -e none.tif ]
}

@test "a thin object beside a thick one is an object, and objects of several labels do not mix" {
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import write
image = np.zeros((30, 30, 60), np.uint8)
image[5:25, 5:25, 5:25] = 1
image[10, 10:20, 27:50] = 1                 # one voxel thin: far below the depth
image[5:25, 5:25, 25] = 2                   # touches the block
image[15:17, 5:25, 40:44] = 2
write("a.tif", image)
PYTHON
    separate_objects a.tif objects.tif --voxel-size 1um --labels 1,2 --min-depth 5um --json found.json
    [ "$(value found.json label_objects)" = "1:2=1,3:4=2" ]
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read
before, after = read("a.tif"), read("objects.tif")
assert set(np.unique(after[before == 1])) == {1, 2} and set(np.unique(after[before == 2])) == {3, 4}
assert (after > 0).sum() == (before > 0).sum()
PYTHON
}

@test "more objects than 16 bits can number" {
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import write
image = np.zeros((82, 82, 82), np.uint8)
image[::2, ::2, ::2] = 1
write("a.tif", image)
PYTHON
    separate_objects a.tif objects.tif --voxel-size 1um --json found.json
    [ "$(value found.json objects)" -eq 68921 ]
    /usr/bin/python3 -c '
import numpy as np
from voxels import read
after = read("objects.tif")
assert after.dtype == np.int32 and after.max() == 68921 and (after > 0).sum() == 68921'
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
    [ -z "$(find . -name '*out*')" ]
}

@test "refuses in one line what it cannot separate" {
    phantom_inclusions a.tif --size 30 --voxel-size 1um --count 2 --fraction 0.1 --quiet
    refused 1 "labels 1, 2: name those whose objects are to be separated, as --labels 1" separate_objects a.tif out.tif
    refused 1 "no label 5" separate_objects a.tif out.tif --labels 5
    refused 2 "from 1 on" separate_objects a.tif out.tif --labels 0
    refused 1 "void everywhere" separate_objects a.tif out.tif --relabel 1=0,2=0
    refused 2 "--min-depth" separate_objects a.tif out.tif --labels 2 --min-depth 2
    refused 1 "'none' does not exist" separate_objects a.tif out.tif --labels 2 --picture none/b.png
}
