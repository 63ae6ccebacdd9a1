#!/usr/bin/env bats
# The demo pipeline on images small enough for seconds.

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    shared=${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}
    cat >scene.toml <<'END'
[phase.matrix]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[phase.inclusion]
label = 2
law = "bilin"
norton = { K = 5020, M = 0.49 }
objects = true
[load]
axis = "z"
steps = [ { strain = -0.04, rate = 1e-3 } ]
[accuracy]
strain_per_step = 2e-4
frames = 4
END
}

pipeline() {
    make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/demo/Makefile" BIN="$TOMODEM_BIN" BRICK_PARTICLES=800 \
        PICTURE_SIZE=240x180 "$@"
}

phantom() { pipeline SCENE=scene.toml PARTICLES=1200 PHANTOM_SIZE=40 PHANTOM_COUNT=3 PHANTOM_GAP=2 "$@"; }

needs_shared() { [ -d "$shared/data" ] || skip "the shared tomographies are not at $shared/data"; }

@test "a dry run shows the whole chain and touches nothing" {
    run -0 phantom OUT=out -n
    for tool in phantom_inclusions packgen vol2pack relax solve render mesh_recon stress_strain shape_factor "bin/report "; do
        [[ $output == *"$tool"* ]]
    done
    [ ! -e out ]
}

@test "a phantom becomes a self-contained report, and a second run does nothing" {
    phantom OUT=out -j2
    [ "$(grep -o 'src="data:image/png;base64,' out/report.html | wc -l)" -eq 6 ]
    for measure in stress_strain shape_factor volume_change equilibrium; do grep -q "id=\"measure-$measure\"" out/report.html; done
    [ "$(grep -o "<svg" out/report.html | wc -l)" -ge 5 ]  # their curves, and what is written over the 3-D view
    run -1 grep -E '(src|href)="(http|/|[a-z_]+\.)' out/report.html
    grep -q "particles lost</td><td>0 of" out/report.html
    phantom OUT=out -q
    run -0 phantom OUT=out
    [[ $output == *"Nothing to be done"* || $output == *"up to date"* ]]
}

@test "a changed variable makes again what depends on it, and nothing else" {
    phantom OUT=out NP=1
    touch -r out/run.h5 run_before && touch -r out/brick.h5 brick_before
    sleep 0.1
    phantom OUT=out NP=1 PICTURE_SIZE=200x150
    [ ! out/run.h5 -nt run_before ]
    [ out/report.html -nt run_before ]
    "$TOMODEM_SOURCE/tests/tools/render/check_picture.py" size out/picture_cut_after.png 200 150

    sed -i 's/-0.04/-0.03/' scene.toml
    phantom OUT=out NP=1 PICTURE_SIZE=200x150
    [ out/run.h5 -nt run_before ]
    [ ! out/brick.h5 -nt brick_before ]
    grep -q '"final_strain": -0.03' out/run.json
}

@test "killed in the middle and run again, the result is the same" {
    phantom OUT=whole NP=1
    for moment in 0.4 1.2 2.0; do
        setsid make --no-print-directory -f "$TOMODEM_SOURCE/pipelines/demo/Makefile" BIN="$TOMODEM_BIN" OUT=killed \
            BRICK_PARTICLES=800 PICTURE_SIZE=240x180 SCENE=scene.toml PARTICLES=1200 PHANTOM_SIZE=40 PHANTOM_COUNT=3 \
            PHANTOM_GAP=2 NP=1 3>&- &
        sleep "$moment"
        kill -9 -- "-$!" || true
        wait "$!" || true
    done
    phantom OUT=killed NP=1
    for table in stress_strain shape_factor volume_change equilibrium; do
        cmp "whole/$table.csv" "killed/$table.csv"
    done
    cmp whole/picture_cut_after.png killed/picture_cut_after.png
}

@test "OBJECTS=watershed separates grains that touch, and each is an object of the run" {
    "$TOMODEM_BIN/phantom_grains" grains.tif --size 50 --voxel-size 10um --fraction 0.5 --count 8 --quiet
    pipeline VOLUME=grains.tif VOXEL_SIZE=10um OBJECTS=watershed PARTICLES=1200 OUT=out out/sample.h5
    [ -s out/objects.png ]
    /usr/bin/python3 -c 'import json
objects, sample = (json.load(open(f"out/{name}.json")) for name in ("objects", "sample"))
assert objects["objects"] == sample["objects"] == 8, (objects["objects"], sample["objects"])
assert objects["components"] < 8'
    run -0 pipeline VOLUME=grains.tif VOXEL_SIZE=10um OBJECTS=watershed PARTICLES=1200 OUT=out out/sample.h5
    [[ $output == *"up to date"* ]]
}

@test "what is missing or wrong is said in one line before anything runs" {
    touch image.tif
    run -2 pipeline OUT=out VOLUME=image.tif
    [[ $output == *"VOXEL_SIZE is missing: give the edge of a voxel with its unit"* ]]
    run -2 pipeline OUT=out VOLUME=nowhere.tif VOXEL_SIZE=1um
    [[ $output == *"VOLUME 'nowhere.tif' does not exist"* ]]
    run -2 pipeline OUT=out VOLUME="a b.tif" VOXEL_SIZE=1um
    [[ $output == *"without spaces"* ]]
    run -2 pipeline OUT=out SCENE=nowhere.toml
    [[ $output == *"SCENE 'nowhere.toml' does not exist"* ]]
    [ ! -e out ]
}

@test "labels that do not fit the image are refused" {
    phantom OUT=out out/volume.tif
    user() { pipeline VOLUME=out/volume.tif VOXEL_SIZE=10um PARTICLES=1200 OUT="$@"; }
    run -2 user a a/scene.toml LABELS=1=matrix
    [[ $output == *"--labels does not name label 2"* ]]
    run -2 user b b/scene.toml LABELS=1=matrix,2=inclusion,5=pore
    [[ $output == *"--labels names label 5 (pore), which the image does not have"* ]]
    run -2 user c c/scene.toml PARTICLES=100
    [[ $output == *"particles, too few to have a shape; give --pixels-per-seed "* ]]
    for folder in a b c; do [ ! -e $folder/scene.toml ]; done
}

@test "without a scene, the largest phase is the matrix and the others are inclusions" {
    phantom OUT=out out/volume.tif
    pipeline VOLUME=out/volume.tif VOXEL_SIZE=10um PARTICLES=1200 RELABEL=1=7 LABELS=7=iron,2=graphite OUT=user \
        user/sample.h5 user/scene.toml
    run -0 cat user/scene.toml
    [[ $output == *'[phase."iron"]'*'label = 7'*'K = 200'*'[phase."graphite"]'*'label = 2'*'K = 5020'*'objects = true'* ]]
    grep -q '"objects": 3' user/sample.json
}

@test "a real tomography of nodules in iron keeps its phase fractions" {
    needs_shared
    pipeline VOLUME="$shared/data/nodular_cast_iron/labels" VOXEL_SIZE=3um LABELS=1=graphite,2=iron OUT=iron \
        ROI=0:150,0:150,0:150 PARTICLES=6000 iron/sample.h5
    /usr/bin/python3 - <<'END'
import json
for phase in json.load(open("iron/sample.json"))["phases"]:
    assert abs(phase["sample_fraction"] - phase["image_fraction"]) < 0.02, phase
END
}

@test "a grey image needs a threshold, and with it is a porous solid" {
    needs_shared
    grey=$shared/data/trabecular_bone/bone_grey.tif
    run -2 pipeline VOLUME="$grey" VOXEL_SIZE=19.5um OUT=grey grey/sample.h5
    [[ $output == *"if it is grey, give --threshold or --otsu"* ]]
    pipeline VOLUME="$grey" VOXEL_SIZE=19.5um THRESHOLD=83 ROI=0:100,0:100,0:100 PARTICLES=3000 OUT=bone bone/sample.h5 \
        bone/scene.toml
    grep -q 'phase."solid"' bone/scene.toml
}
