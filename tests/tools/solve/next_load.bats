bats_require_minimum_version 1.5.0
# A new load from the end of a run.
load common

# scene FILE LAW STEPS [PHASE [CONTACT [ACCURACY [LOAD]]]]
scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "$2"
${4:-repulsive_stiffness = 6.23e9
natural_period = 0.1}

[contact]
$5

[load]
steps = [ $3 ]
$7

[accuracy]
frames = 2
$6
END
}

# step STRAIN
step() { echo "{ strain = $1, rate = 1e-2 }"; }

# goes_on LAW FIRST SECOND WHOLE PHASE CONTACT ACCURACY LOAD SAMPLE [COMMAND...]: strains of the first load, of the next from its
# end, and of both counted from the start; one run of both and two runs end with the same numbers, within $tolerance [mm] where it is set.
goes_on() {
    local law=$1 first=$2 second=$3 whole=$4 rest=("${@:5:4}") sample=$9
    shift 9
    scene first.toml "$law" "$(step "$first")" "${rest[@]}"
    scene second.toml "$law" "$(step "$second")" "${rest[@]}"
    scene whole.toml "$law" "$(step "$first"), $(step "$whole")" "${rest[@]}"
    rm -f ./*.run.h5
    "$@" solve "$sample" whole.toml whole.run.h5 --quiet
    "$@" solve "$sample" first.toml first.run.h5 --quiet
    "$@" solve first.run.h5 --frame last second.toml second.run.h5 --quiet --json second.json
    /usr/bin/python3 - "$first" "$second" "${tolerance:-0}" <<'END'
import json
import sys

import h5py
import numpy as np

strain_first, strain_second, tolerance = map(float, sys.argv[1:])
whole, first, second = (h5py.File(name + ".run.h5") for name in ("whole", "first", "second"))


def particles(run):
    return run["particles/all/position/value"]


assert particles(second)[0].tobytes() == particles(first)[-1].tobytes()
apart = np.abs(particles(second)[-1] - particles(whole)[-1]).max()
print("positions differ by", apart)
assert apart <= tolerance
memory = [run["end/particles/memory"][()] for run in (whole, second)]
assert memory[0].size == memory[1].size and (tolerance > 0 or (memory[0] == memory[1]).all())
curve = {run: run["observables/stress_true/value"][:] for run in (whole, first, second)}
largest = np.abs(curve[whole]).max()
tail = curve[whole][-len(curve[second]):]
assert np.allclose(curve[second], tail, rtol=0, atol=1e-9 * largest)
assert abs(curve[second][0] - curve[first][-1]) < 1e-9 * largest and abs(curve[second][0]) > 0.01 * largest
strain = second["observables/strain/value"][:]
assert strain[0] == 0 and np.isclose(strain[-1], strain_second)
before = second["parameters/tomodem"].attrs
assert np.isclose(before["strain_before"], strain_first)
assert np.isclose(before["time_before"], first["observables/strain/time"][-1])
area, length = (np.prod(second["particles/all/box/edges"][:2]), second["particles/all/box/edges"][2])
assert np.isclose(area, first["observables/section/value"][-1])
assert np.isclose(length / first["particles/all/box/edges"][2], np.exp(strain_first))
assert json.load(open("second.json"))["strain_before"] == before["strain_before"]
END
}

hardening='hardening = { table = [[0, 1], [600, 1.5]] }'
stiff="repulsive_stiffness = 6.23e9
natural_period = 0.1"

@test "BILIN that hardens in time: a run and a next load end as one run of both, bit by bit" {
    make_sample sample.h5
    make_scene relax.toml -0.1
    relax sample.h5 relax.toml relaxed.h5 --quiet
    goes_on bilin -0.1 -0.1 -0.2 "$stiff
$hardening" "" "time_step = 2e-3" "" relaxed.h5
}

@test "TRILIN pulled apart, whose surfaces have met and heal: within rounding, also on two processes" {
    tolerance=1e-12
    make_sample sample.h5 800 0.74
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

with h5py.File("sample.h5", "r+") as file:  # two blocks with a gap between them
    everything = file["particles/all"]
    position = everything["position/value"][0]
    z = position[:, 2]
    keep = np.abs(z - z.mean()) > 0.9
    for name in ("species", "id"):
        values = everything[name][:][keep]
        del everything[name]
        everything[name] = values
    del everything["position/value"]
    everything["position/value"] = position[keep][None]
    everything["box"].attrs["boundary"] = [b"none"] * 3
END
    goes_on trilin -0.4 0.2 -0.2 "$stiff" "self_contact = true
healing_time = '20 s'" "time_step = 2e-3" "" sample.h5
    /usr/bin/python3 -c '
import h5py
end = h5py.File("first.run.h5")["end/particles"]
assert end["memory"].size > 3 * end["tag"].size + 10, end["memory"].size'
    goes_on trilin -0.4 0.2 -0.2 "$stiff" "self_contact = true" "time_step = 2e-3" "" sample.h5 mpirun --oversubscribe -np 2
}

@test "NORTON, which flows with its planes: bit by bit" {
    make_sample sample.h5 500 0.64
    goes_on norton -0.1 0.2 0.1 "norton = { K = 100, M = 0.2 }
$hardening" "" "" "" sample.h5
}

@test "periodic sides and a smooth start: bit by bit" {
    make_sample sample.h5
    scene relax.toml bilin "$(step -0.1)" "$stiff" "" "" 'lateral = "periodic"'
    relax sample.h5 relax.toml relaxed.h5 --quiet
    goes_on bilin -0.1 -0.1 -0.2 "$stiff" "" "time_step = 2e-3" 'lateral = "periodic"
initiation = { strain = 0.02, noise = 0.1 }' relaxed.h5
}

@test "a next load that is killed and resumed is the same bit by bit" {
    make_sample sample.h5
    scene first.toml trilin "$(step -0.1)" "$stiff" "self_contact = true" "time_step = 2e-3"
    scene second.toml trilin "$(step 0.4)" "$stiff" "self_contact = true" "time_step = 2e-3"
    solve sample.h5 first.toml first.h5 --quiet
    solve first.h5 --frame last second.toml whole.h5 --quiet
    solve first.h5 --frame last second.toml run.h5 --quiet & process=$!
    for _ in $(seq 200); do [ -e run.h5.partial ] && break; sleep 0.05; done
    sleep 0.2
    kill $process
    wait $process || true
    [ -e run.h5.checkpoint ]
    solve first.h5 --frame last second.toml run.h5 --quiet --resume
    /usr/bin/python3 -c '
import h5py
a, b = (h5py.File(name)["particles/all/position/value"][-1] for name in ("whole.h5", "run.h5"))
assert a.tobytes() == b.tobytes()'
}

@test "another strength, rate and contact are allowed and said; the material keeps the time that it had" {
    make_sample sample.h5
    scene first.toml bilin "$(step -0.2)" "norton = { K = 95.9, M = 2.45e-3 }
$hardening"
    scene second.toml bilin "{ strain = -0.1, rate = 2e-2 }" "norton = { K = 191.8, M = 2.45e-3 }
$hardening"
    solve sample.h5 first.toml first.h5 --quiet --json first.json
    run -0 --separate-stderr solve first.h5 --frame last second.toml run.h5 --json run.json
    [[ $stderr == *"warning: [phase.a] has K = 191.8, before 95.9"* ]]
    /usr/bin/python3 - <<'END'
import json

first, second = (json.load(open(name + ".json")) for name in ("first", "run"))
assert second["changed_since_run"] == ["[phase.a] has K = 191.8, before 95.9"]
assert abs(second["time_before"] - 20) < 1e-9
ratio = second["final_stress"] / first["final_stress"]
print(ratio)
assert 1.8 < ratio < 2.4
END
}

@test "what a next load cannot be is refused in one line" {
    make_sample sample.h5
    scene first.toml bilin "$(step -0.05)"
    scene second.toml bilin "$(step -0.05)"
    solve sample.h5 first.toml first.h5 --quiet
    refuses 1 "--frame last continues from the end of a run" solve first.h5 second.toml run.h5
    refuses 1 "--frame 1: a load continues from the last frame of a run (--frame last)" solve first.h5 --frame 1 second.toml run.h5
    refuses 1 "it is a sample, not a run; leave --frame out" solve sample.h5 --frame last second.toml run.h5
    scene other.toml trilin "$(step -0.05)"
    refuses 1 "has law trilin, but the run 'first.h5' had bilin" solve first.h5 --frame last other.toml run.h5
    sed 's/steps/axis = "x"\nsteps/' second.toml > other.toml
    refuses 1 "has axis x, but the run 'first.h5' had z" solve first.h5 --frame last other.toml run.h5
    refuses 1 "has axis x, but the run 'first.h5' had z" solve first.h5 --frame last other.toml run.h5 --explain
    sed 's/label = 1/label = 2/' second.toml > other.toml
    refuses 1 "has phases of other labels than the run 'first.h5'" solve first.h5 --frame last other.toml run.h5
    scene other.toml bilin "$(step 0.05)"
    refuses 1 "is tension" solve first.h5 --frame last other.toml run.h5
    cp first.h5 old.h5
    /usr/bin/python3 -c 'import h5py; del h5py.File("old.h5", "r+")["end"]'
    refuses 1 "cannot read 'old.h5': it does not hold the state of its end" solve old.h5 --frame last second.toml run.h5
    solve first.h5 --frame 2 second.toml second.h5 --quiet
}

@test "--explain of a next load says what the run warns of, and its number of steps" {
    make_sample sample.h5
    scene first.toml bilin "$(step -0.05)" "norton = { K = 95.9, M = 2.45e-3 }"
    scene second.toml bilin "$(step -0.05)" "norton = { K = 100, M = 2.45e-3 }"
    solve sample.h5 first.toml first.h5 --quiet
    solve first.h5 --frame last second.toml run.h5 --explain --json said.json 2> said.txt
    [ ! -e run.h5 ]
    solve first.h5 --frame last second.toml run.h5 --json was.json 2> was.txt
    diff said.txt was.txt
    grep -q "has K = 100, before 95.9" was.txt
    /usr/bin/python3 -c '
import json
said, was = (json.load(open(name + ".json")) for name in ("said", "was"))
assert said["steps"] == was["steps"]'
}

@test "tools can go on where planes ended, and planes where tools ended" {
    make_sample sample.h5
    make_plate lower.stl -0.45
    scene first.toml bilin "$(step -0.1)" "$stiff" "" "time_step = 2e-3"
    solve sample.h5 first.toml first.h5 --quiet
    read -r low high < <(/usr/bin/python3 -c '
import h5py
z = h5py.File("first.h5")["particles/all/position/value"][-1][:, 2]
print(z.min() - 0.5, z.max() + 0.5)')
    make_plate lower.stl "$low"
    make_plate upper.stl "$high"
    scene tools.toml bilin "" "$stiff" "" "time_step = 2e-3"
    sed -i 's/^steps.*/duration = "5 s"\nrate = 1e-2/' tools.toml
    printf '[[wall]]\nname = "lower"\nsurface = "lower.stl"\n[[wall]]\nname = "upper"\nsurface = "upper.stl"\nvelocity = [0, 0, -0.08]\n' >> tools.toml
    solve first.h5 --frame last tools.toml tools.h5 --quiet
    solve tools.h5 --frame last first.toml last.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

first, tools, last = (h5py.File(name + ".h5") for name in ("first", "tools", "last"))
height = [np.ptp(run["particles/all/position/value"][-1][:, 2]) for run in (first, tools, last)]
print(height)
assert height[0] - 0.6 < height[1] < height[0] - 0.2  # 5 s at 0.08 mm/s
assert abs(np.log(height[2] / height[1]) + 0.1) < 0.05
assert tools["observables/wall_upper_force_z/value"][-1] != 0
assert np.isclose(last["parameters/tomodem"].attrs["strain_before"], -0.1)
END
}
