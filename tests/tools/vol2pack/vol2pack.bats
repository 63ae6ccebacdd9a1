# vol2pack from a TIFF to a sample, and what it refuses.

load common

@test "the sample has the phases of the image within a point, and its inclusions as objects" {
    vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 1.5 --labels 1=matrix,2=inclusion \
        --objects 2 --json out.json
    [ -e out.xdmf ]
    /usr/bin/python3 - <<'PYTHON'
import json
import h5py
import numpy as np

report, truth = json.load(open("out.json")), json.load(open("composite.json"))
assert [phase["name"] for phase in report["phases"]] == ["void", "matrix", "inclusion"]
for phase in report["phases"]:
    assert abs(phase["sample_fraction"] - phase["image_fraction"]) < 0.01, phase
image = {label["label"]: label["voxel_fraction"] for label in truth["labels"]}
assert abs(report["phases"][2]["image_fraction"] - image[2]) < 1e-12
assert report["objects"] == 8 and report["objects_lost"] == 0

everything = h5py.File("out.h5")["particles/all"]
position, species = (everything[name]["value"][0] if "value" in everything[name] else everything[name][:]
                     for name in ("position", "species"))
object_number = everything["object"]["value"][0] if "value" in everything["object"] else everything["object"][:]
assert len(position) == report["particles"]
assert set(np.unique(object_number)) == set(range(9))
assert ((object_number > 0) == (species == 2)).all()
# Every particle of an object lies in one and the same inclusion of the truth.
centres = np.array([inclusion["centre_mm"] for inclusion in truth["objects"]])
radii = np.array([inclusion["radius_mm"] for inclusion in truth["objects"]])
distance = np.linalg.norm(position[:, None, :] - centres[None], axis=2) - radii
inside = distance.argmin(axis=1)
assert (distance.min(axis=1)[species == 2] < 0.01).all()
assert (distance.min(axis=1)[species == 1] > -0.01).all()
for number in range(1, 9):
    assert len(np.unique(inside[object_number == number])) == 1
PYTHON
}

@test "the file is the same on one thread and on three, but for its command line" {
    vol2pack brick.h5 composite.tif one.h5 --voxel-size 10um --pixels-per-seed 2 --filter box --threads 1 --quiet
    vol2pack brick.h5 composite.tif three.h5 --voxel-size 10um --pixels-per-seed 2 --filter box --threads 3 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
one, three = h5py.File("one.h5"), h5py.File("three.h5")
def compare(name, item):
    if isinstance(item, h5py.Dataset) and name.startswith("particles"):
        assert (item[()] == three[name][()]).all(), name
one.visititems(compare)
PYTHON
}

@test "a folder of slices is read as the multipage file of the same slices" {
    mkdir stack
    /usr/bin/python3 - <<'PYTHON'
from vtkmodules.vtkIOImage import vtkTIFFReader, vtkTIFFWriter
from vtkmodules.vtkImagingCore import vtkExtractVOI
import vtkmodules.vtkCommonCore
reader = vtkTIFFReader()
reader.SetFileName("composite.tif")
reader.SetOrientationType(1)
reader.Update()
for k in range(80):
    voi = vtkExtractVOI()
    voi.SetInputConnection(reader.GetOutputPort())
    voi.SetVOI(0, 79, 0, 79, k, k)
    writer = vtkTIFFWriter()
    writer.SetInputConnection(voi.GetOutputPort())
    writer.SetFileName(f"stack/slice_{k}.tif")
    writer.Write()
PYTHON
    echo "80 slices" > stack/README.md
    "$TOMODEM_BIN/volume_info" composite.tif --voxel-size 10um > multipage.txt
    "$TOMODEM_BIN/volume_info" stack/ --voxel-size 10um > folder.txt
    grep -q "^image: 80 slices of 80 x 80 voxels, uint8, folder of TIFF slices" folder.txt
    cmp <(grep -v "^image" multipage.txt) <(grep -v "^image" folder.txt)
}

@test "the same image in other formats gives the same particles; another volume becomes a property" {
    /usr/bin/python3 - <<'PYTHON'
import gzip
import h5py
import numpy as np
from vtk import vtkTIFFReader
from vtkmodules.util.numpy_support import vtk_to_numpy
reader = vtkTIFFReader()
reader.SetFileName("composite.tif")
reader.SetOrientationType(1)
reader.Update()
voxels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(80, 80, 80).astype(np.uint8)
with h5py.File("scan.h5", "w") as file:
    data = file.create_dataset("exchange/data", data=voxels.astype(">u2"), chunks=(13, 32, 80), compression="gzip")
    data.attrs["element_size_um"] = [10.0, 10.0, 10.0]
    file["heat"] = np.broadcast_to(np.arange(80, dtype=np.float32)[:, None, None], (80, 80, 80))
with open("scan.nrrd", "wb") as file:
    file.write(b'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 80 80 80\nspace units: "um" "um" "um"\n'
               b'spacings: 10 10 10\nencoding: gzip\n\n' + gzip.compress(voxels.tobytes()))
voxels.tofile("scan.dat")
PYTHON
    vol2pack brick.h5 composite.tif tiff.h5 --pixels-per-seed 2 --quiet
    vol2pack brick.h5 scan.h5:/exchange/data hdf5.h5 --pixels-per-seed 2 --quiet --property heat=scan.h5:/heat
    vol2pack brick.h5 scan.nrrd nrrd.h5 --pixels-per-seed 2 --quiet
    vol2pack brick.h5 scan.dat raw.h5 --raw-size 80 --raw-type uint8 --voxel-size 10um --pixels-per-seed 2 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
import numpy as np
files = [h5py.File(f"{name}.h5")["particles/all"] for name in ("tiff", "hdf5", "nrrd", "raw")]
for other in files[1:]:
    assert (other["species"][:] == files[0]["species"][:]).all()
    assert (other["position/value"][:] == files[0]["position/value"][:]).all()
z = files[1]["position/value"][0, :, 2]
assert (files[1]["property/heat"][:] == np.floor(z / 0.01)).all()
inputs = h5py.File("hdf5.h5")["parameters/tomodem/inputs"]
assert b"scan.h5:/heat" in inputs["name"][:].tolist(), inputs["name"][:]
PYTHON
    refused 1 "of no known format" vol2pack brick.h5 composite.tif out.h5 --pixels-per-seed 2 \
        --property "heat=$TOMODEM_SOURCE/README.md"
    refused 1 "does not exist" vol2pack brick.h5 composite.tif out.h5 --pixels-per-seed 2 --property heat=none.tif
}

@test "cropping keeps the world coordinates" {
    vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 1 --roi 10:30,20:40,30:50 \
        --origin 1mm,0mm,0mm --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
position = h5py.File("out.h5")["particles/all/position/value"][0]
for axis, (low, high) in enumerate([(1.1, 1.3), (0.2, 0.4), (0.3, 0.5)]):
    assert low <= position[:, axis].min() < low + 0.02 and high - 0.02 < position[:, axis].max() <= high
PYTHON
}

@test "refuses an image that is not there, is no TIFF, or is cut" {
    refused 1 "none.tif" vol2pack brick.h5 none.tif out.h5 --voxel-size 1um --pixels-per-seed 2
    echo "not a picture" > text.tif
    refused 1 "not a TIFF" vol2pack brick.h5 text.tif out.h5 --voxel-size 1um --pixels-per-seed 2
    head -c $(($(stat -c %s composite.tif) / 2)) composite.tif > cut.tif
    refused 1 "cut or damaged" vol2pack brick.h5 cut.tif out.h5 --voxel-size 1um --pixels-per-seed 2
}

@test "refuses folders without slices, with a gap, or with slices of different size" {
    mkdir stack
    refused 1 "no slice" vol2pack brick.h5 stack out.h5 --voxel-size 1um --pixels-per-seed 2
    for k in 0 1 3; do
        "$TOMODEM_BIN/phantom_inclusions" stack/s_$k.tif --size 20x20x1 --voxel-size 1um --count 1 --diameter 0.01um \
            --gap 0 --quiet
    done
    refused 1 "slice number 2 is missing" vol2pack brick.h5 stack out.h5 --voxel-size 1um --pixels-per-seed 2
    "$TOMODEM_BIN/phantom_inclusions" stack/s_2.tif --size 20x21x1 --voxel-size 1um --count 1 --diameter 0.01um \
        --gap 0 --quiet
    refused 1 "slice 's_2.tif' is 20 x 21" vol2pack brick.h5 stack out.h5 --voxel-size 1um --pixels-per-seed 2
}

@test "refuses a voxel size that nobody gives, another than the file's, and one that is none" {
    printf 'NDims = 3\nDimSize = 1 1 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nabc' > unknown.mha
    refused 1 "give it with --voxel-size" vol2pack brick.h5 unknown.mha out.h5 --pixels-per-seed 2
    refused 1 "says that its voxels are 10 x 10 x 10 um, but 3 um are given" \
        vol2pack brick.h5 composite.tif out.h5 --voxel-size 3um --pixels-per-seed 2
    refused 2 "--voxel-size" vol2pack brick.h5 composite.tif out.h5 --voxel-size 0um --pixels-per-seed 2
    refused 2 "--voxel-size" vol2pack brick.h5 composite.tif out.h5 --voxel-size=-3um --pixels-per-seed 2
    refused 2 "--voxel-size" vol2pack brick.h5 composite.tif out.h5 --voxel-size 3 --pixels-per-seed 2
    refused 2 "--pixels-per-seed" vol2pack brick.h5 composite.tif out.h5 --voxel-size 3um --pixels-per-seed 0
}

@test "refuses labels that do not match the image" {
    refused 1 "label 2" vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2 --labels 1=matrix
    refused 1 "label 7 (steel)" vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2 \
        --labels 1=matrix,2=inclusion,7=steel
    refused 1 "does not have label 5" vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2 \
        --objects 5
    refused 2 "LABEL=NAME" vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2 --labels 1
}

@test "refuses a brick that is cut in half, or is no packing" {
    head -c $(($(stat -c %s brick.h5) / 2)) brick.h5 > half.h5
    refused 1 "half.h5" vol2pack half.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2
    refused 1 "composite.tif" vol2pack composite.tif composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2
}

@test "refuses a crop outside the image, and a phase without particles" {
    refused 1 "does not fit" vol2pack brick.h5 composite.tif out.h5 --voxel-size 10um --pixels-per-seed 2 \
        --roi 0:81,0:80,0:80
    "$TOMODEM_BIN/phantom_inclusions" tiny.tif --size 40 --voxel-size 10um --count 1 --diameter 15um --quiet
    refused 1 "no particle; use fewer --pixels-per-seed" vol2pack brick.h5 tiny.tif out.h5 --voxel-size 10um \
        --pixels-per-seed 8 --quiet
}

@test "leaves an earlier sample as it was when it fails" {
    echo "earlier" > kept.h5
    run vol2pack brick.h5 composite.tif kept.h5 --voxel-size 10um --pixels-per-seed 2 --labels 1=matrix
    [ "$status" -eq 1 ]
    [ "$(cat kept.h5)" = "earlier" ]
}

@test "volume_info reports labels and components" {
    run "$TOMODEM_BIN/volume_info" composite.tif --voxel-size 10um
    [ "$status" -eq 0 ]
    [[ "$output" == *"components_label_2: 8"* ]]
    [[ "$output" == *"size_z: 80 voxels"* ]]
}

@test "--min-component that takes much of the solid away is a warning, and one that takes specks is none" {
    "$TOMODEM_BIN/phantom_inclusions" balls.tif --size 60 --voxel-size 10um --count 8 --diameter 60um:160um --quiet
    for size in 500 2; do
        vol2pack brick.h5 balls.tif out.h5 --relabel 1=0,2=1 --pixels-per-seed 2 --min-component $size --quiet 2>err_$size.txt
    done
    grep -q -- "--min-component 500 takes .* % of the solid out of the image; give a smaller one" err_500.txt
    run -1 grep -q -- "--min-component" err_2.txt
}

@test "the cast iron of the shared data is filled with its phases within a point" {
    data=${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/data/nodular_cast_iron
    [ -d "$data" ] || skip "no real volume at $data (set TOMODEM_SHARED)"
    vol2pack brick.h5 "$data/labels" out.h5 --voxel-size 3um --pixels-per-seed 4 --labels 1=graphite,2=iron \
        --objects 1 --min-component 27 --json out.json
    /usr/bin/python3 - <<'PYTHON'
import json
report = json.load(open("out.json"))
assert report["small_components_removed"] == 5
assert [phase["voxels"] for phase in report["phases"]] == [0, 2861044, 24138956]
assert all(abs(phase["sample_fraction"] - phase["image_fraction"]) < 0.01 for phase in report["phases"])
assert report["objects"] + report["objects_lost"] == 211
PYTHON
}
