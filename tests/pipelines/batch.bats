#!/usr/bin/env bats
# Batches of tiny stacks: what is done, kept, listed.

bats_require_minimum_version 1.5.0

setup() {
    . "$TOMODEM_SOURCE/tests/pipelines/common.bash"
    cd "$BATS_TEST_TMPDIR" || exit 1
    mkdir stacks
    make_scene scene.toml 2e-4
}

batch() { pipeline batch SCENE=scene.toml OUT=out "$@"; }

changed_since() { find out -type f -newer "$1" ! -name log.txt ! -name status ! -name '.digests.json' | sort; }

@test "a dry run shows the chain of every stack and touches nothing" {
    make_stack stacks/one.tif 1
    make_stack stacks/two.tif 2
    run -0 batch -n
    for name in one two; do
        for tool in volume_info vol2pack relax solve stress_strain report; do
            [[ $output == *"bin/$tool "*"out/$name/"* ]]
        done
    done
    [[ $output == *"bin/packgen out/brick.h5"* ]]
    [ ! -e out ]
}

@test "a broken stack is listed with its error, the others finish, one table and one page hold all" {
    make_stack stacks/one.tif 1
    make_stack stacks/two.tif 2
    head -c 500 stacks/one.tif >stacks/broken.tif
    cp stacks/one.tif "stacks/a name.tif"
    make_scene stacks/two.toml 2e-4 2
    sed -i 's/-0.04/-0.02/' stacks/two.toml
    echo 'VOXEL_SIZE = 10um' >stacks/one.mk
    code=0
    batch -j2 2>err.txt || code=$?
    cat err.txt
    [ "$code" != 0 ]
    grep -qE "^broken: failed: (plan|volume_info): cannot read volume 'stacks/broken.tif'" err.txt
    grep -qE "^collect: broken: failed: (plan|volume_info): cannot read volume" err.txt
    grep -q "^collect: a name.tif: failed: make cannot work with this name" err.txt
    [ "$(wc -l <out/batch.csv)" = 5 ]
    [ "$(value_of one status <out/batch.csv)" = "done" ]
    [ "$(value_of one final_strain <out/batch.csv)" = -0.04 ]
    [ "$(value_of two final_strain <out/batch.csv)" = -0.02 ]
    [ "$(value_of broken status <out/batch.csv)" = failed ]
    [[ "$(value_of broken error <out/batch.csv)" == *"cannot read volume"* ]]
    # The flow stress is that at the end of each load, and the page says where that is.
    [ "$(value_of one flow_abs_strain_to <out/batch.csv)" = 0.04 ]
    [ "$(value_of two flow_abs_strain_to <out/batch.csv)" = 0.02 ]
    [ -n "$(value_of two "flow_stress [MPa]" <out/batch.csv)" ]
    grep -q '<small>\(unreliable, \)\?at |strain| 0.0333 to 0.04</small>' out/index.html
    grep -q '<small>\(unreliable, \)\?at |strain| 0.0167 to 0.02</small>' out/index.html
    for column in particles "seed_radius [mm]" "final_stress [MPa]" fraction_inclusion "volume_change_last [%]" "cpu [s]" "peak_memory [MiB]"; do
        [ -n "$(value_of one "$column" <out/batch.csv)" ]
    done
    for link in $(grep -oE '(src|href)="[^"]*"' out/index.html | sed -e 's/.*="//' -e 's/"//'); do
        [ -s "out/$link" ]
    done
    grep -q 'href="two/report.html"' out/index.html
    run -1 grep -q 'href="broken/report.html"' out/index.html
    grep -q -- '--voxel-size 10um' out/one/sample.json
    run -1 grep -q -- '--voxel-size' out/two/sample.json
}

@test "the page fits a window of 1400 pixels, with every measure and long names" {
    command -v chromium >/dev/null || skip "there is no chromium here"
    make_stack stacks/one.tif 1
    batch
    # Two of one strain: it stands in the head.
    name=nodular_cast_iron_of_the_second_casting_sample_number_17_after_annealing
    cp stacks/one.tif "stacks/$name.tif"
    cp -a out/one "out/$name"
    batch collect
    grep -q '<th>flow stress \[MPa\] at |strain| 0.0333 to 0.04</th>' out/index.html
    PYTHONPATH=$TOMODEM_SOURCE/tests/tools/report /usr/bin/python3 - <<'END'
from browser import Browser

with Browser(1400, 900) as browser:
    browser.open("out/index.html")
    widths = browser.evaluate("[document.documentElement, ...document.querySelectorAll('.scroll')].map(e => [e.scrollWidth, e.clientWidth])")
    assert all(inner <= outer <= 1400 for inner, outer in widths), widths
    columns = browser.evaluate("document.querySelectorAll('th').length")
    assert columns >= 12, columns
END
}

@test "a new measure beside the tools has its columns in the table and on the page" {
    make_stack stacks/one.tif 1
    mkdir bin
    cp "$TOMODEM_BIN/report" bin/
    ln -s "$TOMODEM_BIN"/* bin/ 2>/dev/null || true
    cp "$TOMODEM_SOURCE/tests/tools/report/new_measure" bin/sample_height
    rm bin/tools.json
    "$TOMODEM_SOURCE/tools/launcher/list_tools" bin >bin/tools.json
    batch BIN=bin
    height=$(/usr/bin/python3 -c 'import json; print("%.6g" % (json.load(open("out/one/sample_height.json"))["height_last"] * 0.1))')
    [ "$(value_of one "height_last [cm]" <out/batch.csv)" = "$height" ]
    [ "$(value_of one frames_measured <out/batch.csv)" = 5 ]
    run -0 grep -c '<th>height at the end \[cm\]</th>' out/index.html
    # Cases measure with it as well.
    make -n --no-print-directory -f "$TOMODEM_SOURCE/pipelines/cases/two_phases/Makefile" BIN=bin OUT=cases cases/x-1/sample_height.json |
        grep -q 'bin/sample_height cases/x-1/run.h5 cases/x-1/sample_height.csv'
}

@test "HDF5, ESRF's and raw stacks are found, with what says their layout; the voxels of a header are no stack" {
    make_stack one.tif 1
    /usr/bin/python3 - <<'END'
import h5py
from vtk import vtkTIFFReader
from vtk.util.numpy_support import vtk_to_numpy

reader = vtkTIFFReader()
reader.SetFileName("one.tif")
reader.SetOrientationType(1)
reader.Update()
image = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(40, 40, 40)
with h5py.File("stacks/nexus.h5", "w") as file:
    file["entry/labels"] = image
    file["entry/grey"] = 100 * image
    file["entry/labels"].attrs["element_size_um"] = [10.0, 10.0, 10.0]
image.astype("<f4").tofile("stacks/esrf.vol")
open("stacks/esrf.vol.info", "w").write("NUM_X = 40\nNUM_Y = 40\nNUM_Z = 40\nvoxelSize = 10.0\n")
image.tofile("stacks/plain.raw")
image.tofile("stacks/meta.raw")
open("stacks/meta.mhd", "w").write("ObjectType = Image\nNDims = 3\nDimSize = 40 40 40\nElementSpacing = 0.01 0.01 0.01\n"
                                   "ElementType = MET_UCHAR\nElementDataFile = meta.raw\n")
END
    echo 'DATASET = /entry/labels' >stacks/nexus.mk
    printf 'RAW_OPTIONS = --raw-size 40x40x40 --raw-type uint8\nVOXEL_SIZE = 10um\n' >stacks/plain.mk
    echo 'VOXEL_SIZE = 10um' >stacks/meta.mk
    echo 'THRESHOLD = 0.5,1.5' >stacks/esrf.mk
    batch GOAL=sample
    [ "$(wc -l <out/batch.csv)" = 5 ]
    for name in nexus esrf plain meta; do
        [ "$(value_of "$name" status <out/batch.csv)" = "done" ]
    done
    [ "$(for name in nexus esrf plain meta; do value_of "$name" fraction_inclusion <out/batch.csv; done | sort -u | wc -l)" = 1 ]
    touch before
    sleep 0.1
    sed -i 's/voxelSize = 10.0/voxelSize = 12.0/' stacks/esrf.vol.info
    batch GOAL=sample
    [ -n "$(changed_since before | grep out/esrf/sample.h5)" ]
    [ -z "$(changed_since before | grep out/nexus/sample.h5)" ]
}

@test "what is touched and not changed makes nothing again, and a dry run knows" {
    make_stack stacks/one.tif 1
    mkdir stacks/two
    echo 'VOXEL_SIZE = 10um' >stacks/two.mk
    /usr/bin/python3 - <<'END'
from PIL import Image, ImageSequence

for number, slice in enumerate(ImageSequence.Iterator(Image.open("stacks/one.tif"))):
    slice.save(f"stacks/two/slice{number:02d}.tif")
END
    cp -r "$TOMODEM_BIN" bin
    batch -j2 BIN=bin GOAL=run
    batch BIN=bin GOAL=run >/dev/null
    touch mark
    sleep 0.1
    touch stacks/one.tif stacks/two/* scene.toml bin/*
    run -0 batch BIN=bin GOAL=run -n
    [[ $output != *"bin/vol2pack"* && $output != *"bin/solve"* && $output != *"printf"* ]]
    batch BIN=bin GOAL=run
    [ -z "$(changed_since mark)" ]
    echo "# a comment" >>scene.toml
    batch BIN=bin GOAL=run
    [ -z "$(changed_since mark)" ]
}

@test "what is changed is made again from where it matters" {
    make_stack stacks/one.tif 1
    make_stack stacks/two.tif 2
    batch -j2 GOAL=run
    touch mark
    sleep 0.1

    make_scene scene.toml 2e-4 3
    batch GOAL=run
    run -0 changed_since mark
    [[ $output == *out/one/run.h5*out/two/run.h5* ]]
    [[ $output != *relaxed.h5* && $output != *sample.h5* ]]
    batch GOAL=run OUT=fresh
    same_run out/one/run.h5 fresh/one/run.h5

    touch mark
    sleep 0.1
    make_scene scene.toml 1e-4 3
    batch GOAL=run
    run -0 changed_since mark
    [[ $output == *out/one/relaxed.h5*out/one/run.h5* ]]
    [[ $output != *sample.h5* ]]

    touch mark
    sleep 0.1
    date=$(stat -c %y stacks/one.tif)
    make_stack stacks/one.tif 7
    touch -d "$date" stacks/one.tif
    batch GOAL=run
    run -0 changed_since mark
    [[ $output == *out/one/sample.h5* ]]
    [[ $output != *out/two* && $output != *brick* ]]

    touch mark
    sleep 0.1
    rm out/two/run.h5
    batch GOAL=run
    run -0 changed_since mark
    [[ $output == *out/two/run.h5* ]]
    [[ $output != *out/two/relaxed.h5* && $output != *out/one* ]]
}

@test "interrupted, killed and run again, the result is the same, and the run went on from its checkpoint" {
    make_stack stacks/one.tif 1
    make_scene scene.toml 4e-7
    batch GOAL=run OUT=whole
    for signal in INT KILL; do
        # A background job would ignore Ctrl-C, and all that it starts.
        setsid env --default-signal=INT make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/batch/Makefile" \
            BIN="$TOMODEM_BIN" STACKS=stacks PARTICLES=1200 BRICK_PARTICLES=800 SCENE=scene.toml OUT=out GOAL=run 3>&- &
        wait_for 60 test -e out/one/run.h5.partial
        sleep 0.7
        kill -$signal -- "-$!"
        wait "$!" || true
        wait_for 10 flock -n out/one/.lock true
        [ ! -e out/one/run.h5 ]
        [ $signal = KILL ] || [ "$(cat out/one/status)" = interrupted ]
        [ -e out/one/run.h5.checkpoint ]
    done
    code=0
    pipeline batch SCENE=scene.toml OUT=out collect || code=$?
    [ "$code" != 0 ]
    [ "$(value_of one status <out/batch.csv)" = interrupted ]
    batch GOAL=run
    grep -q "resuming at strain -0" out/one/log.txt
    same_run whole/one/run.h5 out/one/run.h5
}

@test "a run does not resume from the checkpoint of another scene" {
    make_stack stacks/one.tif 1
    make_scene scene.toml 4e-7
    batch GOAL=run 3>&- &
    wait_for 60 test -e out/one/run.h5.partial
    sleep 0.5
    kill -USR1 "$(cat out/one/run.pid)"
    wait "$!" || true
    [ -e out/one/run.h5.checkpoint ]
    grep -q "failed: solve: .*stopped by SIGUSR1" out/one/status
    make_scene scene.toml 2e-4
    batch GOAL=run
    [ "$(value_of one final_strain <out/batch.csv)" = -0.04 ]
    run -1 grep -q "resuming at strain" out/one/log.txt
}

@test "two batches do not work on one stack at a time" {
    make_stack stacks/one.tif 1
    mkdir -p out/one
    bash -c 'exec 9>out/one/.lock; flock 9; exec sleep 20' 3>&- &
    holder=$!
    wait_for 5 bash -c '! flock -n out/one/.lock true'
    run batch GOAL=sample
    kill $holder
    [ "$status" != 0 ]
    [[ $output == *"one: failed: another process is at work in out/one"* ]]
    [ ! -e out/one/sample.h5 ]
}

@test "a folder without stacks, or none, is said in one line" {
    run -2 batch
    [[ $output == *"stacks: 'stacks' has no stack"* ]]
    run -2 pipeline batch STACKS=nowhere
    [[ $output == *"there is no folder 'nowhere'; give the one with the stacks as STACKS="* ]]
    [ ! -e out ]
}
