bats_require_minimum_version 1.5.0
load common

@test "the flow stress of a straight line is its value in the middle of the window" {
    "$synthetic_run" run.h5 K=50 slope=200 strain=0.4
    "$TOMODEM_BIN/stress_strain" run.h5 out.csv --at 0.3 --window 0.05 --json out.json
    close "$(value flow_stress out.json)" 110e6 1e-9
    close "$(value flow_strain_rate out.json)" 1e-3 1e-9
    [ "$(value points out.json)" -eq 701 ]
}

@test "the table holds signed and absolute values of the averaged curve" {
    "$synthetic_run" run.h5 K=50 slope=200
    "$TOMODEM_BIN/stress_strain" run.h5 out.csv --averaging-strain 0.02
    [ "$(head -1 out.csv)" = "time [s],strain [-],abs_strain [-],stress_true [Pa],abs_stress_true [Pa],stress_engineering [Pa],abs_stress_engineering [Pa],equilibrium_error [-]" ]
    /usr/bin/python3 -c '
import numpy
t = numpy.genfromtxt("out.csv", delimiter=",", skip_header=1)
assert t.shape == (701, 8), t.shape
assert numpy.allclose(t[:, 3], -50e6 + 200e6 * t[:, 1], rtol=1e-8)
assert numpy.array_equal(t[:, 2], -t[:, 1]) and numpy.array_equal(t[:, 4], -t[:, 3])
assert abs(t[350, 1] + 0.175) < 1e-9 and (t[:, 5] <= t[:, 3]).all()'
}

@test "a stress that the particles cannot carry is called unreliable, with the number that would do" {
    "$synthetic_run" run.h5 K=50 cells=7
    run --separate-stderr "$TOMODEM_BIN/stress_strain" run.h5 out.csv --json out.json
    [ -z "$stderr" ]
    [ "$(value stress_reliable out.json)" = yes ]
    [[ "$output" != *unreliable* && "$output" != *would_do* ]]
    # The same curve with two of three rows of particles across the load only: rods of 2 x 2.
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
with h5py.File("run.h5", "a") as file:
    particles = file["particles/all"]
    first = particles["position/value"][0]
    kept = np.flatnonzero((first[:, :2] % 3 < 1.5).all(axis=1))
    for name in ("id", "species"):
        values = particles[name][:][kept]
        del particles[name]
        particles[name] = values
    values = particles["position/value"][:][:, kept]
    del particles["position/value"]
    particles["position/value"] = values
PYTHON
    run --separate-stderr "$TOMODEM_BIN/stress_strain" run.h5 out.csv --json out.json
    [ "$status" -eq 0 ]
    [ "$(wc -l <<<"$stderr")" -eq 1 ] || { echo "$stderr"; return 1; }
    [[ "$stderr" == *"the stress is unreliable: the parts of the solid are 1.7 particles across"*"particles would do"* ]]
    [ "$(value stress_reliable out.json)" = no ]
    [ "$(value flow_stress_unreliable out.json)" = "$(value flow_stress out.json)" ]
    /usr/bin/python3 -c "assert 5 < $(value particles_that_would_do out.json) / 288 < 6"
    "$synthetic_run" run.h5 equilibrium_error=0.96
    run --separate-stderr "$TOMODEM_BIN/stress_strain" run.h5 out.csv --json out.json
    [[ "$stderr" == *"the forces of the two planes differ by 96 %"* ]]
    [ "$(value stress_reliable out.json)" = no ]
}

# with_scene RUN TEXT: as if it had been solved under another scene
with_scene() {
    /usr/bin/python3 - "$@" <<'PYTHON'
import sys, h5py, numpy as np
with h5py.File(sys.argv[1], "a") as run:
    group = run["parameters/tomodem"]
    del group["scene"]
    group["scene"] = np.bytes_(sys.argv[2])
PYTHON
}

@test "a run is measured whose scene has keys of its time, or a law that this tool does not know" {
    "$synthetic_run" run.h5
    scene='[phase.a]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[load]
steps = [ { strain = -0.3, rate = 1e-3 } ]
'
    with_scene run.h5 "$scene[accuracy]
equilibrium_error = 1e-3"
    "$TOMODEM_BIN/stress_strain" run.h5 old.csv --quiet
    with_scene run.h5 "${scene/bilin/dashpot}"
    "$TOMODEM_BIN/stress_strain" run.h5 other.csv --quiet
    [ -s old.csv ] && [ -s other.csv ]
}

@test "a run that is only partial is called unfinished, and what it holds can be measured" {
    "$synthetic_run" whole.h5
    mv whole.h5 run.h5.partial
    fails 1 "this run is unfinished; give 'run.h5.partial'" "$TOMODEM_BIN/stress_strain" run.h5 out.csv
    "$TOMODEM_BIN/stress_strain" run.h5.partial curve.csv --quiet
}

@test "without averaging the table is the curve itself" {
    "$synthetic_run" run.h5
    "$TOMODEM_BIN/stress_strain" run.h5 out.csv --averaging-strain 0
    [ "$(column "strain [-]" out.csv | tail -1)" = -0.35 ]
}

@test "a run that ends early has its flow stress at its end, and none where it does not reach what is asked for" {
    "$synthetic_run" run.h5 strain=0.1
    "$TOMODEM_BIN/stress_strain" run.h5 early.csv --json out.json
    close "$(value flow_abs_strain_from out.json)" "$(/usr/bin/python3 -c 'print(0.1 - 0.1 * 0.05 / 0.3)')" 1e-9
    close "$(value flow_abs_strain_to out.json)" 0.1 1e-9
    [ -s early.csv ]
    fails 1 "the strain does not get to 0.3: the largest is 0.1" "$TOMODEM_BIN/stress_strain" run.h5 out.csv --at 0.3
}

@test "a sample, a file that is not HDF5 and a missing file are refused" {
    "$synthetic_run" run.h5
    /usr/bin/python3 -c '
import h5py
with h5py.File("run.h5", "a") as f: del f["observables"]'
    fails 1 "no curve 'strain'" "$TOMODEM_BIN/stress_strain" run.h5 out.csv
    echo text >text.h5
    fails 1 "text.h5" "$TOMODEM_BIN/stress_strain" text.h5 out.csv
    fails 1 "none.h5" "$TOMODEM_BIN/stress_strain" none.h5 out.csv
}

@test "a curve that is missing is named" {
    "$synthetic_run" run.h5
    /usr/bin/python3 -c '
import h5py
with h5py.File("run.h5", "a") as f: del f["observables/stress_engineering"]'
    fails 1 "no curve 'stress_engineering'" "$TOMODEM_BIN/stress_strain" run.h5 out.csv
}

@test "a negative window is wrong usage" {
    "$synthetic_run" run.h5
    fails 2 "--window" "$TOMODEM_BIN/stress_strain" run.h5 out.csv --window -0.1
}
