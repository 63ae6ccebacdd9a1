#!/usr/bin/env bats
# What a run does when it is killed, stopped, gone on with, or goes wrong.
load common

# press_scene FILE STRAIN [NATURAL_PERIOD]: 10 steps in a point of the curves, some thousand steps in all
press_scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = ${3:-0.1}

[load]
steps = [ { strain = $2, rate = 1e-2 } ]

[accuracy]
time_step = 1e-3
frames = 6

[output]
velocity = true
stress = true
END
}

make_relaxed() {
    make_sample sample.h5 "${1:-500}"
    press_scene scene.toml "${2:--0.3}"
    relax sample.h5 scene.toml relaxed.h5 --quiet
}

# same A B: every array of both runs is the same, bit by bit
same() {
    /usr/bin/python3 - "$1" "$2" <<'END'
import sys
import h5py

first, second = (h5py.File(name) for name in sys.argv[1:3])
differ = []


def compare(name, item):
    if isinstance(item, h5py.Dataset) and not name.startswith("parameters"):
        if item[()].tobytes() != second[name][()].tobytes():
            differ.append(name)


first.visititems(compare)
assert not differ, differ
END
}

# As long as there is none, the run has not begun.
wait_for() { for _ in $(seq 200); do [ -e "$1" ] && return; sleep 0.05; done; return 1; }

@test "a run killed at ten random moments and resumed is the same bit by bit, and readable at each" {
    make_relaxed 500 -0.6
    solve relaxed.h5 scene.toml whole.h5 --quiet
    kills=0
    progress=0
    for number in $(seq 10); do
        before=$(stat -c %i run.h5.checkpoint 2>/dev/null || true)
        solve relaxed.h5 scene.toml run.h5 --resume --checkpoint-every 0.0005 --quiet & process=$!
        # Every other time at any moment, else some time behind a new checkpoint: so it gets on on a slow machine too.
        for _ in $(seq $((number % 2 * 200))); do
            [ "$(stat -c %i run.h5.checkpoint 2>/dev/null || true)" = "$before" ] || break
            kill -0 $process 2>/dev/null || break
            sleep 0.02
        done
        sleep "0.$((RANDOM % 20 + 10))"
        kill -9 $process 2>/dev/null && kills=$((kills + 1))
        wait $process || true
        [ "$(stat -c %i run.h5.checkpoint 2>/dev/null || true)" = "$before" ] || progress=$((progress + 1))
        [ -e run.h5 ] && break
        [ ! -e run.h5.partial ] || /usr/bin/python3 - <<'END'
import h5py
import numpy as np

run = h5py.File("run.h5.partial")
frames = (run["particles/all/position/step"][:] >= 0).sum()
points = (run["observables/strain/step"][:] >= 0).sum()
assert np.isfinite(run["particles/all/position/value"][:frames]).all()
assert np.isfinite(run["observables/strain/value"][:points]).all()
print(frames, "frames", points, "points")
END
    done
    echo "$kills kills, $progress behind a new checkpoint"
    [ "$kills" -ge 3 ]
    [ "$progress" -ge 2 ]
    solve relaxed.h5 scene.toml run.h5 --resume --quiet
    same whole.h5 run.h5
    [ ! -e run.h5.partial ]
    [ ! -e run.h5.checkpoint ]
}

two() { mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml "$@"; }

@test "SIGTERM stops a run with status 1, and another number of processes can go on with it" {
    make_relaxed
    solve relaxed.h5 scene.toml run.h5 --quiet 2>err.txt & process=$!
    wait_for run.h5.partial
    sleep 0.2
    kill $process
    code=0
    wait $process || code=$?
    cat err.txt
    [ "$code" = 1 ]
    [ "$(wc -l <err.txt)" = 1 ]
    grep -q "stopped by SIGTERM at strain -0.* --resume continues from the checkpoint 'run.h5.checkpoint'" err.txt
    [ ! -e run.h5 ]
    run two run.h5 --resume
    [ "$status" = 0 ]
    [[ "$output" == *"resuming at strain -0."*"another number of processes"* ]]
    [[ "$output" == *"particles_lost: 0"* ]]
}

@test "mpirun passes SIGUSR1 and SIGTERM on to two processes, and --resume goes on bit by bit" {
    make_relaxed 3000
    two whole.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml run.h5 --quiet 2>err.txt & process=$!
    wait_for run.h5.partial
    sleep 0.2
    kill -USR1 $process
    code=0
    wait $process || code=$?
    cat err.txt
    [ "$code" = 1 ]
    [ "$(grep -c "stopped by SIGUSR1 at strain -0.* --resume continues from the checkpoint 'run.h5.checkpoint'" err.txt)" = 1 ]
    [ -e run.h5.checkpoint ]
    # mpirun gives its processes a second after SIGTERM: under load that may be too short for a checkpoint.
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml run.h5 --quiet --resume & process=$!
    sleep 0.3
    kill $process
    wait $process || true
    [ ! -e run.h5 ]
    [ -z "$(find . -name '.*part*')" ]
    two run.h5 --resume --quiet
    same whole.h5 run.h5
}

# frames_in RUN: those written, while it may still be written
frames_in() {
    /usr/bin/python3 -c 'import h5py, sys
try:
    print((h5py.File(sys.argv[1], locking=False)["particles/all/position/step"][:] >= 0).sum())
except (OSError, KeyError, ValueError):
    print(0)' "$1"
}

@test "what contacts remember, hardening and dispersed radii are gone on with too" {
    make_relaxed
    cat > trilin.toml <<'END'
radius_dispersion = 0.05

[phase.a]
label = 1
law = "trilin"
repulsive_stiffness = 6.23e9
natural_period = 0.1
hardening = { table = [[0, 1], [600, 1.2]] }

[contact]
self_contact = true
healing_time = "5 s"

[load]
steps = [ { strain = -0.2, rate = 1e-2 }, { strain = 0.05, rate = 1e-2 } ]

[accuracy]
time_step = 2e-3
frames = 4

[output]
stress = true
END
    solve relaxed.h5 trilin.toml whole.h5 --quiet
    solve relaxed.h5 trilin.toml run.h5 --quiet & process=$!
    wait_for run.h5.partial
    # In tension surfaces have met, and contacts have something to remember.
    for _ in $(seq 100); do
        [ "$(frames_in run.h5.partial)" -ge 3 ] && break
        sleep 0.1
    done
    kill $process
    wait $process || true
    /usr/bin/python3 -c 'import h5py; assert h5py.File("run.h5.checkpoint")["particles/memory"].size > 0'
    solve relaxed.h5 trilin.toml run.h5 --resume --quiet
    same whole.h5 run.h5
}

@test "periodic sides and surfaces are gone on with too" {
    make_sample sample.h5
    cat > periodic.toml <<'END'
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 0.1

[load]
lateral = "periodic"
initiation = { strain = 0.02, noise = 0.1 }
steps = [ { strain = -0.1, rate = [1e-2, 1e-4] }, { strain = -0.2, rate = 1e-2 } ]

[accuracy]
time_step = 1e-3
frames = 4
END
    relax sample.h5 periodic.toml relaxed.h5 --quiet
    /usr/bin/python3 - <<'END'
import struct

import h5py

x = h5py.File("relaxed.h5")["particles/all/position/value"][0]
low, high = x.min(axis=0) - 9, x.max(axis=0) + 9
for name, z in (("die", x[:, 2].min() - 0.5), ("tool", x[:, 2].max() + 0.5)):
    a, b, c, d = ((low[0], low[1], z), (high[0], low[1], z), (high[0], high[1], z), (low[0], high[1], z))
    with open(name + ".stl", "wb") as out:
        out.write(bytes(80) + struct.pack("<I", 2))
        for corners in ((a, b, c), (a, c, d)):
            out.write(struct.pack("<12fH", 0, 0, 1, *sum(corners, ()), 0))
END
    cat > walls.toml <<'END'
[phase.a]
label = 1
law = "bilin"
repulsive_stiffness = 6.23e9
natural_period = 0.1

[load]
duration = "20 s"
rate = 1e-2

[[wall]]
name = "die"
surface = "die.stl"
[[wall]]
name = "tool"
surface = "tool.stl"
velocity = [0, 0, -0.08]

[accuracy]
time_step = 1e-3
frames = 4

[output]
stress = true
END
    for scene in periodic walls; do
        solve relaxed.h5 $scene.toml whole.h5 --quiet
        rm -f run.h5
        solve relaxed.h5 $scene.toml run.h5 --quiet & process=$!
        wait_for run.h5.partial
        sleep 0.2
        kill $process
        wait $process || true
        [ -e run.h5.checkpoint ]
        solve relaxed.h5 $scene.toml run.h5 --resume --quiet
        same whole.h5 run.h5
    done
    run solve relaxed.h5 walls.toml run.h5 --resume
    [[ "$output" == *"is complete"* ]]
    cp die.stl tool.stl
    run solve relaxed.h5 walls.toml run.h5 --resume
    [[ "$output" == *"starting from the beginning"* ]]
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

run = h5py.File("whole.h5")
position, stress = (run[f"particles/all/{name}/value"][-1] for name in ("position", "stress"))
curves = run["observables"]
force = (curves["wall_tool_force_z/value"][-1] - curves["wall_die_force_z/value"][-1]) / 2
total = stress[:, 2].sum() * run["particles/all/stress"].attrs["volume"]
print(total, force * (np.ptp(position[:, 2]) + 1))
assert abs(total / (force * (np.ptp(position[:, 2]) + 2 * run["particles/all"].attrs["seed_radius"])) - 1) < 0.05
END
}

@test "a run is not gone on with under another scene or from another sample" {
    make_relaxed 300
    solve relaxed.h5 scene.toml run.h5 --quiet & process=$!
    wait_for run.h5.partial
    sleep 0.1
    kill $process
    wait $process || true
    [ -e run.h5.checkpoint ]
    press_scene other.toml -0.25
    refuses 1 "cannot resume from 'run.h5.checkpoint': it was made with another scene" \
        solve relaxed.h5 other.toml run.h5 --resume
    refuses 1 "cannot resume from 'run.h5.checkpoint': it was made with another sample or wall" \
        solve sample.h5 scene.toml run.h5 --resume
    mv run.h5.partial elsewhere
    refuses 1 "'run.h5.partial', are not there" solve relaxed.h5 scene.toml run.h5 --resume
    mv elsewhere run.h5.partial
    run solve relaxed.h5 scene.toml run.h5
    [ "$status" = 0 ]
    [[ "$output" == *"starting again: the checkpoint 'run.h5.checkpoint' is removed"* ]]
    [ ! -e run.h5.checkpoint ]
}

@test "--resume begins where there is no checkpoint, and has nothing to do where the run is complete" {
    make_relaxed 300
    run solve relaxed.h5 scene.toml run.h5 --resume
    [ "$status" = 0 ]
    [[ "$output" == *"there is no checkpoint 'run.h5.checkpoint': starting from the beginning"* ]]
    before=$(stat -c %Y%i run.h5)
    run solve relaxed.h5 scene.toml run.h5 --resume
    [ "$status" = 0 ]
    [[ "$output" == *"'run.h5' is complete: nothing to do"* ]]
    [ "$before" = "$(stat -c %Y%i run.h5)" ]
}

@test "planes that run over heavy particles stop the run, and the checkpoint before is named and kept" {
    make_relaxed 300
    press_scene heavy.toml -0.4 200
    sed -i 's/time_step = 1e-3/time_step = 10/' heavy.toml
    refuses_run=0
    solve relaxed.h5 heavy.toml run.h5 --quiet 2>err.txt || refuses_run=$?
    cat err.txt
    [ "$refuses_run" = 1 ]
    grep -q "warning: the planes move by .* crown radii in one natural period" err.txt
    grep -q "the planes have run over .* at strain -0.* (step .*'run.h5.checkpoint'.*'run.h5.partial'" err.txt
    [ -e run.h5.checkpoint ]
    [ -e run.h5.partial ]
}

@test "planes that jump over particles in a step are refused beforehand" {
    make_relaxed 1500
    sed -i 's/time_step = 1e-3/strain_per_step = 0.1/; s/natural_period = 0.1/natural_period = 200/' scene.toml
    refuses 1 "crown radii in one time step (critical regime" solve sample.h5 scene.toml run.h5
    [ ! -e run.h5.partial ]
}

@test "seeds that overlap deeply are a collapsed packing" {
    make_relaxed 300
    /usr/bin/python3 -c 'import h5py; h5py.File("relaxed.h5", "r+")["particles/all"].attrs["seed_radius"] = 0.7'
    refuses 1 "the packing has collapsed at the start (step " solve relaxed.h5 scene.toml run.h5
    [ ! -e run.h5.partial ]
}

@test "an error of LIGGGHTS is one line of ours, also on two processes" {
    make_relaxed 300
    /usr/bin/python3 -c 'import h5py; h5py.File("relaxed.h5", "r+")["particles/all/position/value"][0, 0, :2] = 1e5'
    refuses 1 "LIGGGHTS stopped: Too many atom sorting bins" solve relaxed.h5 scene.toml run.h5
    run mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml run.h5
    [ "$status" = 1 ]
    [ "$(grep -c 'LIGGGHTS stopped' <<<"$output")" = 1 ]
    [[ "$output" != *MPI_ABORT* ]]
}

@test "frames hold velocities and stresses where the scene asks, the same on one and two processes" {
    make_relaxed 2000  # with 500 the last frame alone scatters by 3 % between packings
    press_scene scene.toml -0.12
    solve relaxed.h5 scene.toml one.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml two.h5 --quiet
    sed -i '/velocity = true/d; /stress = true/d' scene.toml
    solve relaxed.h5 scene.toml bare.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

one, two, bare = (h5py.File(name + ".h5")["particles/all"] for name in ("one", "two", "bare"))
assert set(one) - set(bare) == {"velocity", "stress"}
count = one["id"].size
assert one["velocity/value"].shape == (7, count, 3) and one["stress/value"].shape == (7, count, 6)
for name in ("position", "velocity", "stress"):
    a, b = (run[name + "/value"][1] for run in (one, two))
    assert np.abs(a - b).max() <= 1e-6 * np.abs(a).max(), name
    assert (one[name + "/step"][:] == one["position/step"][:]).all()
# The upper end goes down, the lower one up, as the planes do.
order = np.argsort(one["position/value"][-1, :, 2])
v = one["velocity/value"][-1, :, 2][order]
assert v[:50].mean() > 0 > v[-50:].mean(), (v[:50].mean(), v[-50:].mean())
assert np.isnan(one["stress/value"][0]).all()
# The mean of the particles' stresses, over their volume, is the force on the planes times their distance.
stress = one["stress/value"][-1]
curves = h5py.File("one.h5")["observables"]
force = (curves["force_top/value"][-1] - curves["force_bottom/value"][-1]) / 2
extent = np.ptp(one["position/value"][-1, :, 2]) + 2 * one.attrs["seed_radius"]
volume = one["stress"].attrs["volume"]
total = stress[:, 2].sum() * volume
print("sum of V sigma_zz", total, "force times distance", force * extent)
assert abs(total / (force * extent) - 1) < 0.02
END
}
