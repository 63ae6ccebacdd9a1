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

@test "without averaging the table is the curve itself" {
    "$synthetic_run" run.h5
    "$TOMODEM_BIN/stress_strain" run.h5 out.csv --averaging-strain 0
    [ "$(column "strain [-]" out.csv | tail -1)" = -0.35 ]
}

@test "a run that ends early has a curve, and no flow stress unless it is asked for" {
    "$synthetic_run" run.h5 strain=0.1
    run --separate-stderr "$TOMODEM_BIN/stress_strain" run.h5 early.csv --json out.json
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"no flow stress"* ]]
    [[ "$output" != *flow_stress* ]]
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
