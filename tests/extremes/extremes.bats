#!/usr/bin/env bats
# Scenes and samples at the ends of what can be asked: each ends in a right answer or in one clear line.

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
}

# scene FILE LOAD ACCURACY [K_REP] [T0]
scene() {
    cat > "$1" <<END
unusual_values = true
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = ${4:-6.23e9}
natural_period = ${5:-1.0}
[load]
steps = [ $2 ]
[accuracy]
$3
frames = 2
END
}

# cut FILE COUNT: the first particles of a packing alone
cut() {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    /usr/bin/python3 - "$1" "$2" <<'END'
import sys
import h5py

name, count = sys.argv[1], int(sys.argv[2])
with h5py.File("brick.h5") as source, h5py.File(name, "w") as target:
    for key in ("h5md", "parameters"):
        source.copy(key, target)
    everything = target.create_group("particles/all")
    everything.attrs.update(source["particles/all"].attrs)
    for key in ("box", "position", "species", "id"):
        source.copy(f"particles/all/{key}", everything)
    for key in ("species", "id"):
        data = everything[key][:count]
        del everything[key]
        everything[key] = data
    value = everything["position/value"][:, :count]
    del everything["position/value"]
    everything["position/value"] = value
END
}

@test "one particle has no height to press" {
    cut one.h5 1
    scene scene.toml '{ strain = -0.1, rate = 1e-3 }' 'strain_per_step = 5e-5'
    run solve one.h5 scene.toml run.h5
    [ "$status" -eq 1 ]
    [[ "$output" == *"no height along the loading axis"* ]]
    [ ! -e run.h5 ]
}

@test "two and thirty particles are pressed and none is lost" {
    scene scene.toml '{ strain = -0.1, rate = 1e-3 }' 'strain_per_step = 5e-5'
    for count in 2 30; do
        cut few.h5 $count
        solve few.h5 scene.toml run.h5 --json run.json --quiet
        grep -q '"particles_lost": 0' run.json
    done
}

@test "strain -2 keeps every particle" {
    packgen brick.h5 --particles 1000 --density 0.70 --quiet
    scene scene.toml '{ strain = -2, rate = 1e-3 }' 'strain_per_step = 5e-5'
    solve brick.h5 scene.toml run.h5 --json run.json --quiet
    grep -q '"particles_lost": 0' run.json
    grep -q '"final_strain": -2' run.json
}

@test "the stress is proportional to the stiffness over fifteen decades" {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    for stiffness in 1 1e15; do
        scene scene.toml '{ strain = -0.1, rate = 1e-3 }' 'strain_per_step = 5e-5' $stiffness
        solve brick.h5 scene.toml "k$stiffness.h5" --quiet
    done
    /usr/bin/python3 - <<'END'
import h5py
soft, stiff = (h5py.File(f"k{k}.h5")["observables/stress_true/value"][:][1:] for k in ("1", "1e15"))
ratio = stiff / soft
print(ratio[:3], ratio[-3:])
assert abs(ratio[:20] / 1e15 - 1).max() < 1e-6
END
}

@test "a time step above a twentieth of the period is refused" {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    scene scene.toml '{ strain = -0.1, rate = 1e-3 }' 'time_step = 0.1'
    run solve brick.h5 scene.toml run.h5
    [ "$status" -eq 1 ]
    [[ "$output" == *"unstable"* ]]
}

@test "a rate that tears the packing apart ends with the reason and no file" {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    scene scene.toml '{ strain = -1, rate = 10 }' 'time_step = 0.05'
    run solve brick.h5 scene.toml run.h5
    [ "$status" -eq 1 ]
    [[ "$output" == *"falls apart"* || "$output" == *"run over"* || "$output" == *"critical regime"* || "$output" == *"collapses"* ]]
    [ ! -e run.h5 ]
}
