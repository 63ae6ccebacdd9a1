#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# local_threshold as a user runs it.

setup() {
    cd "$BATS_TEST_TMPDIR" || return 1
    PATH=$TOMODEM_BIN:$PATH
    export PYTHONPATH=$TOMODEM_SOURCE/tests/tools/segment
}

@test "recovers phases whose brightness drifts so far that no one threshold separates them" {
    phantom_grains truth.tif --size 80x60x60 --voxel-size 4um --fraction 0.4 --diameter 40um:56um --quiet
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read, write
truth = read("truth.tif")
drift = np.linspace(0, 100, truth.shape[2])[None, None, :]
write("grey.tif", (60 + 50.0 * truth + drift + np.random.default_rng(1).normal(0, 6, truth.shape)).round().astype(np.uint8))
PYTHON
    local_threshold grey.tif labels.tif --voxel-size 4um --radius 10 --picture labels.png --json found.json
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read
truth, grey, labels = read("truth.tif") > 0, read("grey.tif"), read("labels.tif") > 0
best = min(np.mean((grey > cut) != truth) for cut in range(255))
wrong = np.mean(labels != truth)
print(f"wrong: {100 * best:.1f} % with the best global threshold, {100 * wrong:.2f} % with the local one")
assert best > 0.15 and wrong < 0.02
# The threshold is the mean of the box, cropped at the faces.
from scipy.ndimage import uniform_filter
ones = uniform_filter(np.ones(grey.shape), 21, mode="constant")
mean = uniform_filter(grey.astype(float), 21, mode="constant") / ones
sure = np.abs(grey - mean) > 1e-3
assert (labels[sure] == (grey > mean)[sure]).all()
PYTHON
    volume_info labels.tif | grep -q "voxels of 4 x 4 x 4 um, from the file"
    [ -s labels.png ]
    # An offset above the contrast leaves nothing.
    run -1 --separate-stderr local_threshold grey.tif out.tif --voxel-size 4um --radius 10 --offset 200
    [[ "$stderr" == *"every voxel is below the threshold: give another --offset"* ]]
    [ ! -e out.tif ]
    run -2 --separate-stderr local_threshold grey.tif out.tif --voxel-size 4um
    [[ "$stderr" == *"--radius"* ]]
}
