#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# grey_histogram as a user runs it.

setup() {
    cd "$BATS_TEST_TMPDIR" || return 1
    PATH=$TOMODEM_BIN:$PATH
    # Two noisy phases and a few voxels of a third, as VTK writes them.
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from vtk import vtkImageData, vtkMetaImageWriter
from vtkmodules.util.numpy_support import numpy_to_vtk
random = np.random.default_rng(1)
grey = np.where(np.arange(40)[:, None, None] < 12, 60, 150) + random.normal(0, 12, (40, 30, 20))
grey[35:, :10] += 70
np.save("grey.npy", grey.round().astype(np.uint8))
image = vtkImageData()
image.SetDimensions(20, 30, 40)
image.SetSpacing(1, 1, 2)
image.GetPointData().SetScalars(numpy_to_vtk(grey.round().astype(np.uint8).ravel(), deep=True))
writer = vtkMetaImageWriter()
writer.SetInputData(image)
writer.SetCompression(True)
writer.SetFileName("grey.mhd")
writer.SetRAWFileName("grey.zraw")
writer.Write()
PYTHON
}

@test "thresholds are those of the definition, found by trying all" {
    grey_histogram grey.mhd one.png --json one.json
    grey_histogram grey.mhd two.png --otsu 2 --json two.json
    /usr/bin/python3 - <<'PYTHON'
import json, itertools
import numpy as np
grey = np.load("grey.npy").astype(float).ravel()
def between(cuts):
    classes = np.digitize(grey, [c + 0.5 for c in cuts])
    return sum((classes == k).sum() * (grey[classes == k].mean() - grey.mean())**2
               for k in range(len(cuts) + 1) if (classes == k).any())
one, two = json.load(open("one.json")), json.load(open("two.json"))
best = max(range(40, 200), key=lambda cut: between([cut]))
assert one["threshold_1"] == best, (one["threshold_1"], best)
found = between([two["threshold_1"], two["threshold_2"]])
for pair in itertools.combinations(range(80, 210, 3), 2):
    assert between(pair) <= found * (1 + 1e-12), pair
assert abs(one["fraction_label_1"] - 100 * (grey > best).mean()) < 1e-9
assert sum(one["counts"]) == grey.size
PYTHON
}

@test "vol2pack and volume_info cut where grey_histogram says" {
    grey_histogram grey.mhd picture.png > found.txt
    volume_info grey.mhd --voxel-size 2um --otsu 1 > otsu.txt
    volume_info grey.mhd --voxel-size 2um --threshold "$(sed -n 's/^threshold_1: //p' found.txt)" > given.txt
    cmp <(grep voxels_label otsu.txt) <(grep voxels_label given.txt)
    grep -q "voxels of 2 x 2 x 4 um, in the file's proportions" otsu.txt
}

@test "the picture shows the curve and a red line at each threshold" {
    grey_histogram grey.mhd picture.png --threshold 100,190
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from vtk import vtkPNGReader
from vtkmodules.util.numpy_support import vtk_to_numpy
reader = vtkPNGReader()
reader.SetFileName("picture.png")
reader.Update()
width, height, _ = reader.GetOutput().GetDimensions()
pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)[..., :3].astype(int)
red = (pixels[..., 0] > 150) & (pixels[..., 1] < 120)
columns = np.flatnonzero(red.sum(axis=0) > height / 2)
assert 2 <= len(columns) <= 8, columns
assert columns.max() - columns.min() > width / 10, columns
blue = (pixels[..., 2] > 120) & (pixels[..., 0] < 90)
assert blue.sum() > 500, blue.sum()
PYTHON
}

@test "bad thresholds, an image of one grey value and a folder that is not there are refused in one line" {
    run -2 --separate-stderr grey_histogram grey.mhd a.png --threshold 190,100
    [[ "$stderr" == *"--threshold '190,100': expected numbers that rise"* ]]
    run -2 --separate-stderr grey_histogram grey.mhd a.png --threshold 100 --otsu 1
    [[ "$stderr" == *"exclude each other"* ]]
    run -1 --separate-stderr grey_histogram grey.mhd a.png --roi 0:1,0:1,0:1
    [[ "$stderr" == *"needs more than 1 grey value"* ]]
    run -1 --separate-stderr grey_histogram grey.mhd none/a.png
    [[ "$stderr" == *"'none' does not exist"* ]]
    [ ! -e a.png ]
    [ "${#stderr_lines[@]}" -eq 1 ]
}
