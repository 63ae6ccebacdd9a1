#!/usr/bin/env bats
# The law NORTON through the tools: 300 particles, so stresses are those of a small sample.
load common

make_brick() { packgen "$1" --particles 300 --density 0.64 --quiet; }

# norton_scene FILE STEPS [CONTACT] [ACCURACY]
norton_scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "norton"
norton = { K = 100, M = ${M:-0.5} }
$3
[load]
steps = [ $2 ]
[accuracy]
frames = 2
$4
END
}

# holds RUN CONDITION: a Python expression of e (strain), s (stress in MPa) and error
holds() {
    /usr/bin/python3 - "$@" <<'END'
import sys, h5py, numpy as np
file = h5py.File(sys.argv[1])["observables"]
e, s, error = file["strain/value"][:], file["stress_true/value"][:] / 1e6, file["equilibrium_error/value"][:]
late = np.abs(e) > 0.1
print(e[-1], s[late].mean(), error[late].mean())
assert eval(sys.argv[2]), sys.argv[2]
END
}

@test "a small sample carries about K rate^M in compression, and as much in tension" {
    make_brick brick.h5
    norton_scene press.toml "{ strain = -0.2, rate = 1e-3 }"
    norton_scene pull.toml "{ strain = 0.2, rate = 1e-3 }"
    solve brick.h5 press.toml press.h5 --quiet
    solve brick.h5 pull.toml pull.h5 --quiet
    holds press.h5 'abs(s[late].mean() / (-100 * 1e-3**0.5) - 1) < 0.25'
    holds pull.h5 'abs(s[late].mean() / (100 * 1e-3**0.5) - 1) < 0.25'
}

@test "stress does not look at the time step" {
    make_brick brick.h5
    norton_scene whole.toml "{ strain = -0.15, rate = 1e-3 }" "" 'scheme = "explicit"'
    solve brick.h5 whole.toml whole.h5 --quiet --json whole.json
    half=$(/usr/bin/python3 -c 'import json; print(json.load(open("whole.json"))["time_step"] / 2)')
    norton_scene half.toml "{ strain = -0.15, rate = 1e-3 }" "" "scheme = \"explicit\"
time_step = $half"
    solve brick.h5 half.toml half.h5 --quiet
    stress=$(/usr/bin/python3 -c '
import h5py
f = h5py.File("whole.h5")["observables"]
print(f["stress_true/value"][:][abs(f["strain/value"][:]) > 0.1].mean() / 1e6)')
    holds half.h5 "abs(s[late].mean() / $stress - 1) < 0.01"
    norton_scene longer.toml "{ strain = -0.15, rate = 1e-3 }" "" "scheme = \"explicit\"
time_step = 1"
    refuses 1 'time_step 1 s is longer than law "norton" is stable with' solve brick.h5 longer.toml longer.h5
}

@test "pressing, pulling back and a change of the rate in one run, gone on with after a stop" {
    make_brick brick.h5
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }, { strain = -0.15, rate = 3e-3 }, { strain = 0.0, rate = 1e-3 }" \
        "" 'scheme = "explicit"'
    solve brick.h5 scene.toml whole.h5 --quiet
    solve brick.h5 scene.toml run.h5 --quiet --checkpoint-every 0.0001 &
    for _ in $(seq 200); do [ -e run.h5.checkpoint ] && break; sleep 0.05; done
    kill -9 $! || true
    wait $! || true
    solve brick.h5 scene.toml run.h5 --quiet --resume
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
a, b = h5py.File("whole.h5"), h5py.File("run.h5")
for name in ("observables/stress_true/value", "particles/all/position/value"):
    assert np.array_equal(a[name][:], b[name][:]), name
strain, stress = a["observables/strain/value"][:], a["observables/stress_true/value"][:]
assert stress[np.argmin(strain) - 2] < 0 < stress[-2], "tension after the reversal"
END
}

@test "several processes give the same curve within half a hundredth" {
    make_brick brick.h5
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }"
    relax brick.h5 scene.toml sample.h5 --quiet
    solve sample.h5 scene.toml one.h5 --quiet
    mpirun --oversubscribe -np 2 solve sample.h5 scene.toml two.h5 --quiet
    /usr/bin/python3 -c '
import h5py, numpy as np
one, two = (h5py.File(f"{name}.h5")["observables/stress_virial/value"][1:] for name in ("one", "two"))
assert np.abs(two / one - 1).max() < 0.005, np.abs(two / one - 1).max()'
}

@test "explain says the scheme, what set the time step, and what the run takes" {
    make_brick brick.h5
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }"
    run -0 solve --explain brick.h5 scene.toml run.h5
    [[ "$output" == *"viscous_flow_and_pressure_of_the_density: on"* ]]
    [[ "$output" == *'velocities_that_are_found: on: scheme = "quasi_static"'* ]]
    [[ "$output" == *"time_step_reason: a strain of 0.008 in a step at the highest rate"* ]]
    for what in steps evaluations predicted_wall_seconds predicted_peak_bytes; do [[ "$output" == *$'\n'"$what: "[0-9]* ]]; done
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }" "" 'scheme = "explicit"'
    run -0 solve --explain brick.h5 scene.toml run.h5
    [[ "$output" == *'velocities_that_are_found: off: scheme = "explicit"'* ]]
    [[ "$output" == *"time_step_reason: viscous stability at half the lowest rate"* ]]
    [[ "$output" != *$'\n'"evaluations: "* ]]
}

@test "a run keeps the scheme that it began with" {
    make_brick brick.h5
    # Long enough that it is still running when it is killed.
    norton_scene scene.toml "{ strain = -0.3, rate = 1e-3 }" "" "strain_per_step = 5e-4"
    relax brick.h5 scene.toml sample.h5 --quiet
    solve sample.h5 scene.toml whole.h5 --quiet
    solve sample.h5 scene.toml run.h5 --quiet --checkpoint-every 0.00001 & process=$!
    for _ in $(seq 400); do [ -e run.h5.checkpoint ] && break; sleep 0.01; done
    kill -9 $process
    wait $process || true
    [ ! -e run.h5 ]
    # As of a version that took explicit steps where the scene says nothing.
    cp run.h5.checkpoint kept.checkpoint
    /usr/bin/python3 - <<'END'
import h5py
with h5py.File("run.h5.checkpoint", "r+") as file:
    scene = open("scene.toml").read()
    inputs = file["inputs"]
    assert inputs["scene"].asstr()[()].startswith(scene)
    del inputs["scene"]
    inputs["scene"] = scene
END
    refuses 1 'it was made in explicit steps, then the default of its law' solve sample.h5 scene.toml run.h5 --resume
    cp kept.checkpoint run.h5.checkpoint
    solve sample.h5 scene.toml run.h5 --quiet --resume
    # What is stored repeats the run.
    /usr/bin/python3 -c 'import h5py
open("stored.toml", "w").write(h5py.File("run.h5")["parameters/tomodem/scene"].asstr()[()])'
    grep -q '^scheme = "quasi_static"' stored.toml
    solve sample.h5 stored.toml again.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
whole = h5py.File("whole.h5")
for other in ("run.h5", "again.h5"):
    for name in ("observables/stress_true/value", "particles/all/position/value"):
        assert whole[name][:].tobytes() == h5py.File(other)[name][:].tobytes(), (other, name)
END
}

@test "what does not go with the law is refused with its line" {
    make_brick brick.h5
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }"
    with() { sed "$1" scene.toml > bad.toml; refuses 1 "$2" solve brick.h5 bad.toml run.h5; }
    with 's/^norton = .*/&\nnatural_period = 1/' 'line 5: natural_period belongs to the other laws'
    with 's/^norton = .*/repulsive_stiffness = 1e9/' 'belongs to the other laws'
    with 's/^frames.*/scheme = "explicit"\nstrain_per_step = 1e-5/' 'chooses the time step by inertia_share'
    with 's/^frames.*/inertia_share = 0.02/' 'line 9: inertia_share belongs to explicit steps'
    sed 's/^frames.*/inertia_share = 0.02\nscheme = "explicit"/' scene.toml > told.toml
    solve brick.h5 told.toml told.h5 --explain --quiet
    with '1i radius_dispersion = 0.1' 'is made for equal radii'
    with '1i crown_radius = 0.7' 'is made for a crown_radius of 1.5 seed radii'
    with 's/M = 0.5/M = 1.2/' 'M in norton is above 1'
    with '$a [contact]\nself_contact = true' 'line 12: law "norton" cannot tell surfaces that meet'
    sed 's/"norton"/"bilin"/; s/^frames.*/reference_rate = 1e-3/' scene.toml > bad.toml
    refuses 1 'reference_rate belongs to law "norton"' solve brick.h5 bad.toml run.h5
}

@test "surfaces pull a sample apart: each feels the tension that the planes would" {
    make_brick brick.h5
    norton_scene planes.toml "{ strain = 0.15, rate = 1e-3 }"
    relax brick.h5 planes.toml sample.h5 --quiet
    # Plates a little inside the outermost centres' seeds, so that they hold as many as planes do.
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
z = h5py.File("sample.h5")["particles/all/position/value"][0, :, 2]
low, high = np.sort(z)[4] - 0.5, np.sort(z)[-5] + 0.5
print(low, high, file=open("heights", "w"))
with open("scene.toml", "w") as file:
    file.write(open("planes.toml").read().replace('steps = [ { strain = 0.15, rate = 1e-3 } ]',
                                                  'duration = "150 s"\nrate = 1e-3'))
    for name, speed in (("die", 0), ("tool", 1e-3 * (high - low - 1))):
        file.write(f'[[wall]]\nname = "{name}"\nsurface = "{name}.stl"\nvelocity = [0, 0, {speed}]\n')
END
    read -r low high <heights
    make_plate die.stl "$low"
    make_plate tool.stl "$high"
    solve sample.h5 planes.toml planes.h5 --quiet
    solve sample.h5 scene.toml walls.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
planes, walls = h5py.File("planes.h5")["observables"], h5py.File("walls.h5")["observables"]
section = np.prod(h5py.File("planes.h5")["particles/all/box/edges"][:2])
expected = planes["stress_true/value"][-20:].mean() * section * np.exp(-0.14)
tool, die = (walls[f"wall_{name}_force_z/value"][-20:].mean() for name in ("tool", "die"))
print(expected, tool, die)
assert expected > 0 and abs(tool / expected - 1) < 0.3 and abs(die / -expected - 1) < 0.3
END
}

@test "a sample of another density is said to change its size, and packgen --law makes one that does not" {
    phantom_inclusions image.tif --size 30 --voxel-size 10um --count 1 --diameter 120um --quiet
    norton_scene scene.toml "{ strain = -0.1, rate = 1e-3 }"
    for density in "--density 0.70" "--density 0.655" "--density 0.645" "--law norton"; do
        # shellcheck disable=SC2086
        packgen brick.h5 --particles 300 $density --quiet
        vol2pack brick.h5 image.tif sample.h5 --relabel 2=1 --pixels-per-seed 2.4 --quiet
        for tool in "relax sample.h5 scene.toml relaxed.h5" "solve sample.h5 scene.toml run.h5 --explain" "relax brick.h5 scene.toml relaxed.h5"; do
            run -0 --separate-stderr $tool --quiet
            case $density in
                *0.70) [[ $stderr == *'the sample will grow by about 9 % in volume; make the brick with packgen --law norton'* ]] ;;
                *0.655) [[ $stderr == *'has a density of 0.655'* ]] ;;
                *) [[ $stderr != *density* ]] ;;
            esac
        done
    done
    # What is at rest is said nothing of.
    run -0 --separate-stderr solve relaxed.h5 scene.toml run.h5 --explain --quiet
    [[ $stderr != *density* ]]
}
