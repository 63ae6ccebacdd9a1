#!/usr/bin/env bats
# plan: from an image and a scene to a setting, and the scene with it.

bats_require_minimum_version 1.5.0

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    "$TOMODEM_BIN/phantom_inclusions" two.tif --size 60 --voxel-size 10um --count 4 --diameter 200um --quiet
}

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
    image=$BATS_FILE_TMPDIR/two.tif
    cat > scene.toml <<'END'
# A composite of mine.
[phase.matrix]
label = 1
law = "bilin"   # or another
norton = { K = 100, M = 0.1 }
[phase.inclusion]
label = 2
law = "bilin"
norton = { K = 5020, M = 0.49 }
objects = true

[load]
steps = [ { strain = -0.05, rate = 1e-3 } ]   # little
[accuracy]
frames = 2
strain_per_step = 2e-5   # fine
END
}

# json FILE EXPRESSION of j
json() { /usr/bin/python3 -c 'import json, sys; j = json.load(open(sys.argv[1])); print(eval(sys.argv[2]))' "$1" "$2"; }
holds() { [ "$(json "$@")" = True ]; }

# A table whose answer can be worked out: 10 % at 6 particles across, whatever the time step.
table() {
    cat <<END
[trade]
format = 1
name = "made up"
processor = "none"
[trade.bilin]
density = 0.7
[trade.bilin.shape_factor]
resolution = [3, 6, 12]
bias = [0.2, 0.1, 0.05]
spread = [0, 0, 0]
step = [1e-4]
step_error = [0]
particle_step = 5e-8
bytes = [1e7, 1000]
prepare = [0, 0]
END
}

@test "the resolution follows from the table and the diameter of the spheres" {
    table > table.toml
    plan "$image" proposed.toml --scene scene.toml --error 10% --of shape_factor --table table.toml --json plan.json --quiet
    # 20 voxels across, 6 particles: 1.67 voxels a seed radius, at most the 3 % finer of a step of the search.
    holds plan.json '0.96 * 20 / 12 < j["pixels_per_seed"] < 1.01 * 20 / 12'
    holds plan.json 'abs(j["features"][0]["median"] / 0.2 - 1) < 0.01 and j["features"][0]["count"] == 4'
    holds plan.json 'j["law"] == "bilin" and j["strain_per_step"] == 1e-4 and j["steps"] == 500'
    holds plan.json 'abs(j["predicted_cpu_seconds"] / (5e-8 * 500 * j["particles"]) - 1) < 1e-3'
    holds plan.json 'abs(j["predicted_peak_bytes"] / (1e7 + 1000 * j["particles"]) - 1) < 1e-3'
}

@test "the scene proposed differs in law and time step alone, comments are kept, and solve accepts it" {
    run -0 --separate-stderr plan "$image" proposed.toml --scene scene.toml --error 20%
    lines=$(diff scene.toml proposed.toml | grep -c '^>') || true
    [ "$lines" -le 3 ]
    [ "$(wc -l < scene.toml)" -eq "$(wc -l < proposed.toml)" ]
    for comment in '# A composite of mine.' '# or another' '# little' '# fine'; do grep -qF "$comment" proposed.toml; done
    # The commands that it prints, as they stand.
    for tool in packgen vol2pack relax; do
        eval "$(sed -n "s/^command_$tool: //p" <<<"$output") --quiet"
    done
    eval "$(sed -n 's/^command_solve: //p' <<<"$output") --explain --json explain.json --quiet"
    particles=$(sed -n 's/^particles: //p' <<<"$output")
    holds explain.json "abs(j['particles'] / $particles - 1) < 0.03"
    steps=$(sed -n 's/^steps: //p' <<<"$output")
    holds explain.json "abs(j['steps'] / $steps - 1) < 0.1"
}

@test "without a name the scene proposed is written beside the scene" {
    plan "$image" --scene scene.toml --error 20% --quiet
    [ -s scene.proposed.toml ]
}

@test "voxel size, threshold and labels are read as by the other tools, and go into the commands" {
    /usr/bin/python3 -c '
import numpy as np
z, y, x = np.mgrid[:40, :40, :40] + 0.5 - 20
open("grey.raw", "wb").write(np.where(x*x + y*y + z*z < 12**2, 200, 100).astype(np.uint8).tobytes())'
    table > table.toml
    run -0 --separate-stderr plan grey.raw --raw-size 40x40x40 --raw-type uint8 --voxel-size 5um --threshold 50,150 \
        --relabel 1=1,2=2 --scene scene.toml --error 10% --of shape_factor --table table.toml
    [[ $output == *'objects_of_inclusion: 1 of them, median diameter 0.1'* ]]
    [[ $output == *'vol2pack brick.h5 grey.raw sample.h5 --voxel-size 0.005mm --threshold 50,150 --raw-size 40x40x40 --raw-type uint8 --relabel 1=1,2=2 --pixels-per-seed '*' --objects 2'* ]]
}

@test "an error out of reach is refused with the smallest in reach and what limits it; nothing is written" {
    table > table.toml
    run -1 plan "$image" proposed.toml --scene scene.toml --error 4% --of shape_factor --table table.toml --quiet
    [[ $output == 'plan: an error of 4 % is out of reach: the smallest is 5 % of shape_factor, with law "bilin", strain_per_step = 0.0001 and '*' particles; resolution limits it; give --error 5%' ]]
    [ ! -e proposed.toml ]
    # Of the table that ships too, the error that it names can be had.
    run -1 plan "$image" proposed.toml --scene scene.toml --error 0.1% --quiet
    # shellcheck disable=SC2046
    plan "$image" proposed.toml --scene scene.toml $(sed 's/.*give //' <<<"$output") --quiet
    [ -s proposed.toml ]
}

@test "what no law can hold is refused with what can be done, which can be" {
    sed -i 's/-0.05/0.05/' scene.toml
    run -1 plan "$image" proposed.toml --scene scene.toml --error 20% --law bilin --quiet
    [[ $output == *'no law can hold scene'*'; without --law, "norton" can' ]]
    plan "$image" proposed.toml --scene scene.toml --error 20% --quiet
    sed -i 's/-0.05/-0.1/; s/"bilin"/"trilin"/; s/K = 100, M = 0.1/K = 100, M = 0.0714/; s/M = 0.49/M = 0.0714/' scene.toml
    sed -i 's/0.05, rate/-0.05, rate/' scene.toml
    run -1 plan "$image" proposed.toml --scene scene.toml --error 20% --law trilin --of shape_factor,composite_stress --quiet
    [[ $output == *'; without --law, "'*'" can' ]]
    printf '[contact]\nself_contact = true\n' >> scene.toml
    table > table.toml
    sed -i 's/bilin/norton/; s/step = \[1e-4\]/step = [8e-3]/' table.toml
    run -1 plan "$image" proposed.toml --scene scene.toml --error 20% --of shape_factor --table table.toml --quiet
    [[ $output == *'; --particles instead of --error makes the chain for the scene as it is, its error unknown' ]]
    plan "$image" proposed.toml --scene scene.toml --particles 2000 --quiet
}

@test "grains in void stay apart: void is never made their phase" {
    /usr/bin/python3 -c '
import numpy as np
z, y, x = np.mgrid[:60, :60, :60]
off = np.stack([(axis % 20) - 9.5 for axis in (z, y, x)])
open("grains.raw", "wb").write(np.where((off**2).sum(0) < 8.5**2, 255, 0).astype(np.uint8).tobytes())'
    cat > grains.toml <<'END'
[phase.grain]
label = 1
law = "bilin"
norton = { K = 50, M = 0.1 }
objects = true
[load]
steps = [ { strain = -0.05, rate = 1e-3 } ]
[accuracy]
frames = 1
END
    image=(grains.raw --raw-size 60 --raw-type uint8 --voxel-size 10um --relabel 255=1)
    run -0 --separate-stderr plan "${image[@]}" --scene grains.toml --error 20%
    [[ $output == *'objects_of_grain: 27 of them'* ]]
    [[ $output == *'vol2pack brick.h5 grains.raw sample.h5 '*' --relabel 255=1 '*' --objects 1'* ]]
    [[ $output != *command_carve* ]]
    sed -n 's/^command_[a-z0-9_]*: //p' <<<"$output" > commands.sh
    bash -eu commands.sh > chain.txt
    grep -qx 'objects: 27' chain.txt
    # Void that no face meets does not change that.
    /usr/bin/python3 -c '
import numpy as np
v = np.fromfile("grains.raw", np.uint8).reshape(60, 60, 60)
v[22:38, 22:38, 22:38] = np.where(v[22:38, 22:38, 22:38] == 0, 0, 255)
frame = np.full((70, 70, 70), 255, np.uint8)
frame[5:65, 5:65, 5:65] = v
frame.tofile("closed.raw")'
    run -0 --separate-stderr plan closed.raw "${image[@]:1:1}" 70 "${image[@]:3}" --scene grains.toml --error 20% --of shape_factor
    [[ $output != *'0=1'* ]]
}

@test "a label for each object: hundreds of them are no grey image, and the commands keep them" {
    /usr/bin/python3 -c '
import numpy as np
z, y, x = np.mgrid[:84, :84, :84]
off = np.stack([(axis % 14) - 6.5 for axis in (z, y, x)])
number = 10 + (z // 14) * 36 + (y // 14) * 6 + x // 14
open("labels.raw", "wb").write(np.where((off**2).sum(0) < 6.9**2, number, 2).astype(np.uint16).tobytes())'
    sed -i 's/label = 1/label = 9/; s/label = 2/label = 1/; s/label = 9/label = 2/' scene.toml  # matrix 2, inclusions 1
    image=(labels.raw --raw-size 84 --raw-type uint16 --voxel-size 10um)
    run -0 plan "${image[@]}" proposed.toml --scene scene.toml --error 30%
    [[ $output == *'each is taken as an object of its own (--objects labels)'* ]]
    [[ $output == *'objects_of_inclusion: 216 of them, median diameter 0.1'* ]]
    [[ $output == *' --label-objects 10:225=1'* ]]
    plan "${image[@]}" proposed.toml --scene scene.toml --pixels-per-seed 1.1 --objects labels > plan.txt
    sed -n 's/^command_[a-z0-9_]*: //p' plan.txt | head -2 > commands.sh
    bash -eu commands.sh > chain.txt
    grep -qx 'objects: 216' chain.txt
    # Without a scene they are one phase; by components the matrix has none of their labels.
    run -0 plan "${image[@]}" made.toml --pixels-per-seed 1.1
    [[ $output == *'--label-objects 2:225=1'* ]]
    run -1 plan "${image[@]}" made.toml --pixels-per-seed 1.1 --objects components --quiet
    [[ $output == *'if each value is an object, --objects labels' ]]
}

@test "objects to be separated by a watershed get a step of their own" {
    plan "$image" --scene scene.toml --error 30% --objects watershed > plan.txt 2> notes.txt
    [ "$(sed -n 's/^command_separate_objects: //p' plan.txt)" = "separate_objects $image objects.tif --labels 2" ]
    grep -q '^command_vol2pack: vol2pack brick.h5 objects.tif sample.h5 --pixels-per-seed [0-9.]* --label-objects 2:99999999=2$' plan.txt
    grep -q 'still to be separated' notes.txt
    sed -i 's/norton = { K = 100/objects = true\nnorton = { K = 100/' scene.toml
    run -1 plan "$image" --scene scene.toml --error 30% --objects watershed --quiet
    [[ $output == *'marks the objects of 2 phases (inclusion, matrix)'* || $output == *'marks the objects of 2 phases (matrix, inclusion)'* ]]
}

@test "pores that carve takes as open, and loads that the table was not measured under, are noted" {
    phantom_pores pores.tif --size 60 --voxel-size 10um --porosity 0.04 --median-diameter 250um --spread 0 --clusters 0 --gap 3 --quiet
    printf '[phase.a]\nlabel = 1\nlaw = "norton"\nnorton = { K = 50, M = 0.1 }\n[load]\nsteps = [ { strain = -0.2, rate = 1e-3 } ]\n' > s.toml
    run -0 plan pores.tif --scene s.toml --error 20%
    [[ $output != *"this load is another one"* ]]
    sed -i 's/strain = -0.2/strain = 0.3/' s.toml
    run -0 plan pores.tif --scene s.toml --error 20%
    [[ $output == *"the errors are those of samples pressed once"*"this load is another one"* ]]
    phantom_pores near.tif --size 32 --voxel-size 10um --porosity 0.2 --median-diameter 230um --spread 0 --clusters 0 --gap 2 --quiet
    run -0 plan near.tif --scene s.toml --error 20%
    [[ $output == *"the pores are not carved (each passes through the image, or nearly so, "* ]]
    [[ $output == *"command_relax"* ]]
    # One behind a thin wall is carved, and carve takes it.
    /usr/bin/python3 -c '
import numpy as np
z, y, x = np.mgrid[:50, :50, :50] + 0.5
open("wall.raw", "wb").write(((x - 15)**2 + (y - 25)**2 + (z - 25)**2 >= 13**2).astype(np.uint8).tobytes())'
    run -0 plan wall.raw wall.toml --raw-size 50 --raw-type uint8 --voxel-size 10um --scene s.toml --error 20%
    [[ $output == *"1 of 1 pores that carve takes out meet a face of the image or come within two particles of one"* ]]
    sed -n 's/^command_[a-z0-9_]*: //p' <<<"$output" | head -3 > commands.sh
    bash -eu commands.sh
    [ -s relaxed.h5 ]
}

@test "tension leaves BILIN out" {
    sed -i 's/-0.05/0.05/' scene.toml
    run -0 --separate-stderr plan "$image" proposed.toml --scene scene.toml --error 20%
    [[ $output == *'law: norton'* ]]
    [[ $stderr == *'not law "bilin": '*'tension'* ]]
    [[ $output == *'scheme: quasi_static'*'evaluations: '* ]]
    grep -q '^strain_per_step = 0.008 ' proposed.toml
    [ "$(grep -c 'law = "norton"' proposed.toml)" -eq 2 ]
}

@test "for a number of particles it writes the scene of the labels and the options of the chain, which the tools accept" {
    plan "$image" made.toml --particles 2000 --options options --json plan.json --quiet
    holds plan.json 'abs(j["particles"] / 2000 - 1) < 0.02 and j["options"]["shape_factor"] == "--min-particles 20"'
    grep -q '^--pixels-per-seed .* --labels 1=matrix,2=inclusion --objects 2 --min-component ' options/vol2pack
    packgen brick.h5 --particles 2000 --law norton --quiet
    # shellcheck disable=SC2046
    vol2pack brick.h5 "$image" sample.h5 $(cat options/vol2pack) --json sample.json --quiet
    holds sample.json 'abs(j["particles"] / 2000 - 1) < 0.1 and j["objects"] == 4'
    solve sample.h5 made.toml run.h5 --explain --quiet
    # Of another load the sample's options are not written, and those of the load need no image.
    sed 's/-0.05/-0.1/' scene.toml > other.toml
    plan "$image" other_made.toml --scene other.toml --particles 2000 --options load --write load --quiet
    cmp other.toml other_made.toml
    [ "$(cat load/equilibrium)" = "--from 0.0666667" ]
    [ "$(ls load)" = "$(printf 'equilibrium\npress')" ]
    plan "$image" none.toml --scene other.toml --particles 2000 --density 0.64 --options sample --write sample --quiet
    [ ! -e none.toml ]
    cmp sample/mesh_recon options/mesh_recon
    [ ! -e sample/press ]
}

@test "what is wrong is said in one line" {
    run -2 plan "$image" proposed.toml --scene scene.toml
    [[ $output == 'plan: give --error, --particles or --pixels-per-seed'* ]]
    run -2 plan "$image" proposed.toml --scene scene.toml --error 5% --labels 1=a,2=b
    [[ $output == 'plan: --labels goes with --particles or --pixels-per-seed'* ]]
    run -2 plan "$image" --particles 2000
    [[ $output == 'plan: give PROPOSED'* ]]
    run -1 plan "$image" proposed.toml --particles 20
    [[ $output == 'plan: the largest inclusion would have '*' particles, too few to have a shape; give --pixels-per-seed '* ]]
    run -2 plan "$image" proposed.toml --error 5%
    [[ $output == 'plan: give the --scene'* ]]
    run -2 plan "$image" proposed.toml --scene scene.toml --error 5% --of shape
    [[ $output == "plan: --of 'shape': 'shape' is none of flow_stress, "* ]]
    sed 's/label = 2/label = 3/' scene.toml > other.toml
    run -1 plan "$image" proposed.toml --scene other.toml --error 5% --quiet
    [[ $output == "plan: scene 'other.toml' has no phase with label 2, which the image has"* ]]
    table | sed 's/^bias/bais/' > table.toml
    run -1 plan "$image" proposed.toml --scene scene.toml --error 5% --table table.toml --quiet
    [[ $output == "plan: table 'table.toml' line "*"[trade.bilin.shape_factor] has no 'bias'" ]]
    [ ! -e proposed.toml ]
}
