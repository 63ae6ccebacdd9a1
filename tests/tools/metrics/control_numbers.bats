bats_require_minimum_version 1.5.0
load common
synthetic_fields="$TOMODEM_BIN/../tests/synthetic_fields"
control_numbers="$TOMODEM_BIN/control_numbers"

@test "the numbers are those of the scene's constants and the curves" {
    "$synthetic_fields" run.h5 field=0 cells=8 stress=-100
    "$control_numbers" run.h5 out.csv --curve curve.csv --json out.json
    # k = 5e9 uN/mm, d = 1 mm, P = 1e8 Pa; t0 = 0.1 s and m = k t0^2 / 4 pi^2, so I = rate t0 / 2 pi sqrt(50).
    close "$(value stiffness_level_last out.json)" 50 1e-9
    close "$(value inertial_number_last out.json)" 1.12539540e-4 1e-8
    close "$(value Q_last out.json)" "$(/usr/bin/python3 -c 'print(64 / 2048 / 1e8)')" 1e-9
    close "$(value kinetic_over_elastic_last out.json)" 0.002 1e-9
    [ "$(wc -l <curve.csv)" -eq 302 ]
    [ "$(column "stiffness_level [-]" curve.csv | head -1)" = "" ]
    close "$(column "chi [-]" out.csv | tail -1)" 0.02 1e-9
    [ "$(column "phase [-]" out.csv | tail -1)" = matrix ]
}

@test "a calibrated run gives no warning, one out of range does" {
    "$synthetic_fields" run.h5 field=0 cells=5
    run --separate-stderr "$control_numbers" run.h5 fine.csv
    [ "$status" -eq 0 ] && [ -z "$stderr" ]
    "$synthetic_fields" hot.h5 field=0 cells=5 kinetic=100
    run --separate-stderr "$control_numbers" hot.h5 hot.csv
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"E_k / E_p is 0.2"* && "$stderr" == *"hot"* ]]
    "$synthetic_fields" soft.h5 field=0 cells=5 stress=-1000
    run --separate-stderr "$control_numbers" soft.h5 soft.csv
    [[ "$stderr" == *"stiffness level 5 "* ]]
    "$synthetic_fields" light.h5 field=0 cells=5 stress=-0.01
    run --separate-stderr "$control_numbers" light.h5 light.csv
    [[ "$stderr" == *"inertial number 0.011"* ]]
}

@test "an equilibrium error above the thesis' one per cent is a warning" {
    "$synthetic_fields" run.h5 field=0 cells=5 imbalance=0.009
    run --separate-stderr "$control_numbers" run.h5 fine.csv --json out.json
    [ "$status" -eq 0 ] && [ -z "$stderr" ]
    close "$(value equilibrium_error out.json)" 0.009 1e-9
    "$synthetic_fields" bad.h5 field=0 cells=5 imbalance=0.02
    run --separate-stderr "$control_numbers" bad.h5 bad.csv
    [[ "$stderr" == *"equilibrium error is 0.02 on average"* ]]
}

@test "two phases have rows of their own" {
    "$synthetic_fields" run.h5 field=0 phases=2
    "$control_numbers" run.h5 out.csv --frames last
    [ "$(column "phase [-]" out.csv | tr '\n' ',')" = ",matrix,inclusion," ]
    [ "$(column "particles [-]" out.csv | tr '\n' ',')" = "864,432,432," ]
}

@test "a sample, a run without curves or scene, two particles and a missing frame are refused" {
    "$synthetic_fields" sample.h5 field=0 frames=1 curves=0
    refused 1 "no curve 'strain'" "$control_numbers" sample.h5 out.csv --curve curve.csv
    "$synthetic_fields" nameless.h5 field=0 scene=0
    refused 1 "holds no scene" "$control_numbers" nameless.h5 out.csv
    "$synthetic_fields" two.h5 field=0 particles=2
    refused 1 "frame 0" "$control_numbers" two.h5 out.csv
    "$synthetic_fields" run.h5 field=0
    refused 1 "frames 0 to 2" "$control_numbers" run.h5 out.csv --frames 7
    /usr/bin/python3 -c '
import h5py
with h5py.File("run.h5", "a") as f: del f["observables/kinetic_energy"]'
    refused 1 "no curve 'kinetic_energy'" "$control_numbers" run.h5 out.csv
}
