#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# denoise as a user runs it.

setup() {
    cd "$BATS_TEST_TMPDIR" || return 1
    PATH=$TOMODEM_BIN:$PATH
    export PYTHONPATH=$TOMODEM_SOURCE/tests/tools/segment
    # Two phases of a phantom as grey values 90 and 150, with noise of standard deviation 30.
    phantom_grains truth.tif --size 60x56x50 --voxel-size 4um --fraction 0.4 --count 12 --quiet
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read, write
random = np.random.default_rng(3)
truth = read("truth.tif")
noisy = 90.0 + 60 * truth + random.normal(0, 30, truth.shape)
write("grey.tif", noisy.round().clip(0, 255).astype(np.uint8))
write("grey16.tif", (200 * noisy).round().clip(0, 65535).astype(np.uint16))
write("float.tif", noisy.astype(np.float32))
PYTHON
}

@test "the median is scipy's, voxel by voxel, in the type of the image" {
    for name in grey grey16 float; do
        denoise $name.tif median_$name.tif --voxel-size 4um --median 1 --threads 2
    done
    denoise grey.tif wide.tif --voxel-size 4um --median 2 --origin 1mm,2mm,3mm
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from scipy.ndimage import median_filter
from voxels import read
for name in "grey", "grey16", "float":
    before, after = read(f"{name}.tif"), read(f"median_{name}.tif")
    assert before.dtype == after.dtype
    assert (after == median_filter(before, 3, mode="nearest")).all(), name
assert (read("wide.tif") == median_filter(read("grey.tif"), 5, mode="nearest")).all()
PYTHON
    volume_info wide.tif --otsu 1 | grep -q "voxels of 4 x 4 x 4 um, from the file"
    /usr/bin/python3 -c '
import tifffile, json
said = json.loads(tifffile.TiffFile("wide.tif").pages[0].description)
assert said["origin_mm"] == [1, 2, 3], said'
}

@test "after Otsu's threshold fewer voxels are wrong: from 17 % to 2 and 1 %" {
    denoise grey.tif median.tif --voxel-size 4um --median 1 --picture median.png
    denoise grey.tif diffusion.tif --voxel-size 4um --diffusion 10
    separate() { separate_objects "$1" labels_"$1" --otsu 1 "${@:2}" --min-depth 1mm --quiet; }
    separate grey.tif --voxel-size 4um
    separate median.tif
    separate diffusion.tif
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read
truth = read("truth.tif") > 0
wrong = {name: 100 * np.mean((read(f"labels_{name}.tif") > 0) != truth) for name in ("grey", "median", "diffusion")}
print(wrong)
assert wrong["grey"] > 15
assert wrong["median"] < 2.5 and wrong["diffusion"] < 1.5
PYTHON
}

@test "diffusion keeps the mean, and keeps an edge that a mean of the same strength blurs" {
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import write
random = np.random.default_rng(5)
step = np.where(np.arange(40) < 20, 50.0, 200.0) + random.normal(0, 5, (30, 30, 40))
write("step.tif", step.astype(np.float32))
PYTHON
    denoise step.tif smooth.tif --voxel-size 1um --diffusion 20
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from voxels import read
before, after = read("step.tif"), read("smooth.tif")
assert abs(before.mean() - after.mean()) < 0.05
assert after[:, :, :15].std() < 0.4 * before[:, :, :15].std()
jump = after[:, :, 20].mean() - after[:, :, 19].mean()
print("noise", after[:, :, :15].std(), "jump", jump)
assert jump > 0.95 * 150
PYTHON
}

@test "refuses in one line what it cannot filter" {
    refused() {
        run --separate-stderr "${@:3}"
        echo "status $status: $stderr"
        [ "$status" -eq "$1" ]
        [ "${#stderr_lines[@]}" -eq 1 ]
        [[ "$stderr" == *"$2"* ]]
        [ ! -e out.tif ]
    }
    refused 2 "give the filter" denoise grey.tif out.tif --voxel-size 1um
    refused 2 "exclude each other" denoise grey.tif out.tif --voxel-size 1um --median 1 --diffusion 2
    refused 2 "--edge belongs to --diffusion" denoise grey.tif out.tif --voxel-size 1um --median 1 --edge 2
    refused 1 "give it with --voxel-size" denoise grey.tif out.tif --median 1
    /usr/bin/python3 -c '
import numpy as np
from voxels import read, write
a = read("float.tif"); a[7, 3, 2] = np.nan; write("nan.tif", a)
write("wide.tif", np.full((6, 7, 5), 16777217, np.uint32))'
    refused 1 "slice 7 has a value that is not a finite number" denoise nan.tif out.tif --voxel-size 1um --median 1
    refused 1 "the value 16777217" denoise wide.tif out.tif --voxel-size 1um --median 1
}
