#!/usr/bin/env bats
# plan on the five real images (../shared/data): every command that it proposes, as it stands, to the end of solve.

bats_require_minimum_version 1.5.0

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
    data=$TOMODEM_SOURCE/../shared/data
    [ -d "$data" ] || skip "no ../shared/data"
    data=$(realpath "$data")
}

# scene FILE PHASE LABEL EXTRA [PHASE LABEL EXTRA]...
scene() {
    local file=$1
    shift
    while [ $# -gt 0 ]; do
        printf '[phase.%s]\nlabel = %s\nlaw = "bilin"\nnorton = { K = 50, M = 0.0714 }\n%s\n' "$1" "$2" "$3"
        shift 3
    done > "$file"
    printf '[load]\nsteps = [ { strain = -0.05, rate = 1e-3 } ]\n[accuracy]\nframes = 2\n' >> "$file"
}

# proposal PLAN_ARGUMENT...: runs plan, and then each of its commands in this folder
proposal() {
    plan "$@" > plan.txt
    sed -n 's/^command_[a-z0-9_]*: //p' plan.txt > commands.sh
    [ "$(wc -l < commands.sh)" -ge 4 ]
    bash -eu commands.sh > chain.txt 2>&1 || { cat plan.txt chain.txt; return 1; }
    [ -s run.h5 ]
}

proposes() { grep -q "^command_$1: " plan.txt; }

@test "cast iron: objects in a matrix" {
    scene scene.toml nodule 1 'objects = true' iron 2 ''
    proposal "$data/nodular_cast_iron/labels" --scene scene.toml --error 20% --voxel-size 3um --roi 0:80,0:80,0:80
    grep -q 'vol2pack .*--objects 1$' plan.txt
}

@test "cast iron: its nodules as pores are filled and carved, those at the faces too" {
    scene scene.toml iron 1 ''
    proposal "$data/nodular_cast_iron/labels" --scene scene.toml --error 25% --voxel-size 3um --roi 0:90,0:90,0:90 \
        --relabel 1=0,2=1
    proposes carve
    grep -q -- '--relabel 0=1,1=1,2=1 ' plan.txt
    grep -q '^cut_pores: [1-9]' chain.txt
}

@test "bone, grey: struts" {
    scene scene.toml bone 1 ''
    proposal "$data/trabecular_bone/bone_grey.tif" --scene scene.toml --error 100% --voxel-size 19.5um --otsu 1 \
        --roi 0:56,0:56,0:56
    proposes relax
    grep -q 'predicted_error_foam_stress' plan.txt
}

@test "fibres: struts, and the stress of few particles is called unreliable" {
    scene scene.toml fibre 1 ''
    proposal "$data/polymer_fibres/fibres_labels.tif" --scene scene.toml --error 100% --voxel-size 2um --roi 0:48,0:48,0:48
    proposes relax
    plan "$data/polymer_fibres/fibres_labels.tif" coarse.toml --scene scene.toml --particles 1500 --voxel-size 2um \
        --roi 0:48,0:48,0:48 > coarse.txt 2> notes.txt
    grep -q 'stress of this sample would be unreliable: its struts are [0-2][0-9.]* particles across, 3 are' notes.txt
    # What it says would do, does.
    finer=$(sed -n 's/.*(--pixels-per-seed \([0-9.]*\)) would do.*/\1/p' notes.txt)
    plan "$data/polymer_fibres/fibres_labels.tif" finer.toml --scene scene.toml --pixels-per-seed "$finer" \
        --voxel-size 2um --roi 0:48,0:48,0:48 > finer.txt 2> notes.txt
    run ! grep -q unreliable notes.txt
}

@test "liquid foam: struts, and a number of particles" {
    scene scene.toml liquid 1 ''
    proposal "$data/liquid_foam/foam_labels.tif" --scene scene.toml --error 100% --voxel-size 5um --roi 0:40,0:40,0:40
    proposes relax
    proposal "$data/liquid_foam/foam_labels.tif" made.toml --particles 3000 --voxel-size 5um --roi 0:40,0:40,0:40
}

@test "sand: grains in void, by components" {
    scene scene.toml grain 1 'objects = true' dense 2 ''
    proposal "$data/sand_pack/sand_labels.mhd" --scene scene.toml --error 30% --voxel-size 5um --roi 140:200,0:60,40:100
    proposes relax
    run ! grep -q -- '--relabel' plan.txt
}

@test "sand: touching grains are separated by a watershed" {
    [ -x "$TOMODEM_BIN/separate_objects" ] || skip "separate_objects is not built"
    scene scene.toml grain 1 'objects = true' dense 2 ''
    proposal "$data/sand_pack/sand_labels.mhd" --scene scene.toml --error 30% --voxel-size 5um --roi 140:200,0:60,40:100 \
        --objects watershed
    proposes separate_objects
    [ "$(sed -n 's/^objects: //p' chain.txt | head -1)" -gt 10 ]
}
