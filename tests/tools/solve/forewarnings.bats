bats_require_minimum_version 1.5.0
# What is said before a run: names that do not agree, values that nobody means, and the same warnings by --explain.
load common

# two_phases FILE MATRIX INCLUSION: labels of the phases
two_phases() {
    cat > "$1" <<END
[phase.matrix]
label = $2
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }

[phase.inclusion]
label = $3
law = "bilin"
norton = { K = 200, M = 2.45e-3 }

[load]
steps = [ { strain = -0.02, rate = 1e-2 } ]
END
}

@test "labels that have changed places between image and scene are refused, and the advice helps" {
    phantom_inclusions image.tif --size 40 --voxel-size 10um --fraction 0.15 --count 3 --quiet
    packgen brick.h5 --particles 2000 --density 0.70 --quiet
    vol2pack brick.h5 image.tif sample.h5 --voxel-size 10um --pixels-per-seed 1.5 --labels "2=matrix,1=inclusion" --quiet
    two_phases scene.toml 1 2
    wrong="[phase.inclusion] has label 2, but in the sample (vol2pack --labels) label 1 is 'inclusion'; write label = 1 there"
    refuses 1 "$wrong" relax sample.h5 scene.toml run.h5
    refuses 1 "$wrong" solve sample.h5 scene.toml run.h5
    refuses 1 "$wrong" solve sample.h5 scene.toml run.h5 --explain
    two_phases other.toml 2 1
    relax sample.h5 other.toml relaxed.h5 --quiet
    refuses 1 "$wrong" solve relaxed.h5 scene.toml run.h5
    solve relaxed.h5 other.toml run.h5 --quiet
    /usr/bin/python3 -c '
import h5py
labels = h5py.File("run.h5")["parameters/tomodem/labels"]
assert dict(zip(labels["label"][:], labels["name"].asstr()[:])) == {1: "inclusion", 2: "matrix"}'
    vol2pack brick.h5 image.tif named.h5 --voxel-size 10um --pixels-per-seed 1.5 --labels "1=matrix,2=inclusion" --quiet
    relax named.h5 scene.toml relaxed.h5 --quiet 2> err.txt
    [ ! -s err.txt ]
}

@test "labels of other words are one warning, and a sample without names says nothing" {
    make_sample sample.h5
    make_scene scene.toml -0.02
    run -0 --separate-stderr solve sample.h5 scene.toml run.h5 --quiet
    [ -z "$stderr" ]
    /usr/bin/python3 -c '
import h5py
group = h5py.File("sample.h5", "r+").create_group("parameters/tomodem/labels")
group["label"] = [1]
group["name"] = [b"iron"]'
    for command in relax solve; do
        run -0 --separate-stderr $command sample.h5 scene.toml out.h5 --quiet
        [ "$stderr" = "$command: warning: label 1 is 'iron' in the sample and [phase.a] in the scene: are they the same?" ]
    done
}

@test "K in Pa and strain in per cent are refused in one line, and the first line of the scene insists" {
    make_sample sample.h5
    two_phases scene.toml 1 2
    sed -i '/inclusion/,/^$/d; s/K = 95.9/K = 95.9e6/' scene.toml
    for tool in relax solve; do
        refuses 1 "K is in MPa.s^M (if this one is in Pa.s^M, write 95.9); if it is meant, write unusual_values = true" \
            $tool sample.h5 scene.toml run.h5
    done
    sed -i 's/95.9e6/95.9/; s/strain = -0.02/strain = -30/' scene.toml
    refuses 1 "strain = -30 leaves 9.4e-14 times the height" solve sample.h5 scene.toml run.h5 --explain
    sed -i '1i unusual_values = true' scene.toml
    solve sample.h5 scene.toml run.h5 --explain --quiet
    sed -i 's/strain = -30/strain = -0.02/; s/K = 95.9/K = 95.9e6/' scene.toml
    solve sample.h5 scene.toml run.h5 --quiet
}

# says_the_same SAMPLE SCENE WARNING...: what --explain and the run say are the same lines, and these are among them. What the run
# says of its result is not known before.
says_the_same() {
    local sample=$1 scene=$2
    shift 2
    solve "$sample" "$scene" run.h5 --explain 2> said.txt > /dev/null
    solve "$sample" "$scene" run.h5 2> all.txt > /dev/null
    grep -v "the forces of the two planes differ" all.txt > was.txt
    cat was.txt
    diff said.txt was.txt
    for warning in "$@"; do grep -qF -- "$warning" was.txt; done
    rm -f run.h5
}

@test "--explain says every warning that the run begins with" {
    make_sample sample.h5
    /usr/bin/python3 - <<'END'
import h5py
file = h5py.File("sample.h5", "r+")
group = file.create_group("parameters/tomodem/labels")
group["label"] = [1]
group["name"] = [b"iron"]
species = file["particles/all/species"]
species[:250] = 2
END
    cat > bilin.toml <<'END'
[phase.soft]
label = 1
law = "bilin"
norton = { K = 5, M = 2.45e-3 }
hardening = { table = [[0, 1], [1, 1.2]] }
[phase.hard]
label = 2
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[load]
steps = [ { strain = -0.02, rate = 1e-2 } ]
END
    relax sample.h5 bilin.toml relaxed.h5 --quiet 2> /dev/null
    says_the_same relaxed.h5 bilin.toml "label 1 is 'iron' in the sample and [phase.soft] in the scene" \
        "[phase.soft] is outside its calibration: 500 particles" "[phase.hard] is 19.2 times as stiff as [phase.soft]" \
        "hardening of [phase.soft] ends at 1 s and the load at 2 s"
    cat > heavy.toml <<'END'
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 15
[phase.b]
label = 2
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 15
[load]
steps = [ { strain = -0.02, rate = 1e-2 } ]
[accuracy]
time_step = 0.1
END
    says_the_same relaxed.h5 heavy.toml "inertia may carry 10 % of the load at 0.01 /s"
    cat > norton.toml <<'END'
[phase.a]
label = 1
law = "norton"
norton = { K = 100, M = 0.2 }
[phase.b]
label = 2
law = "norton"
norton = { K = 100, M = 0.2 }
[load]
steps = [ { strain = -0.02, rate = 1e-2 } ]
[accuracy]
scheme = "explicit"
inertia_share = 0.2
END
    says_the_same relaxed.h5 norton.toml "inertia_share = 0.2"
}

@test "a sample relaxed under another law is relaxed again, and one relaxed under another strength is said to be" {
    make_sample sample.h5
    scene() { make_scene "$1" -0.02; sed -i "s/law = .*/law = \"$2\"/; /repulsive/d; s/natural_period.*/norton = { K = $3, M = 0.0714 }/; /time_step/d" "$1"; }
    scene bilin.toml bilin 50
    scene strong.toml bilin 60
    scene trilin.toml trilin 50
    relax sample.h5 bilin.toml relaxed.h5 --quiet
    run -0 --separate-stderr solve relaxed.h5 bilin.toml run.h5
    [[ $stderr != *relaxed* ]]
    run -0 --separate-stderr solve relaxed.h5 strong.toml strong.h5 --json strong.json
    [[ $stderr == *"since the sample was relaxed: [phase.a] has K = 60, before 50"* ]]
    run -0 --separate-stderr solve relaxed.h5 trilin.toml again.h5
    [[ $stderr == *"relaxed as another material (law \"bilin\""*"it is relaxed before the load"* ]]
    run -0 solve relaxed.h5 trilin.toml again.h5 --explain
    [[ $output == *"relaxation_first: on"* ]]
    /usr/bin/python3 - <<'END'
import json

import h5py
import numpy as np

assert json.load(open("strong.json"))["changed_since_relaxation"] == ["[phase.a] has K = 60, before 50"]
# The rest of one phase does not depend on its strength: the stress is in proportion, until the motion gets chaotic.
weak, strong = (h5py.File(name + ".h5")["observables/stress_true/value"][1:5] for name in ("run", "strong"))
assert np.allclose(strong / weak, 60 / 50, rtol=1e-3), strong / weak
END
}
