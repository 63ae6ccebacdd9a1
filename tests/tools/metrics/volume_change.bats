bats_require_minimum_version 1.5.0
load common

@test "a known change of volume is found" {
    "$synthetic_run" run.h5 strain=0.1 frames=5 volume_factor=0.95
    "$TOMODEM_BIN/volume_change" run.h5 out.csv --probe-radius 1mm --json out.json
    close "$(value volume_first out.json)" 216 1e-9
    close "$(value volume_change_last out.json)" -0.05 1e-9
    close "$(value volume_change_extreme out.json)" -0.05 1e-9
    [ "$(column "components [-]" out.csv | tr '\n' ' ')" = "1 1 1 1 1 " ]
    close "$(column "volume_change [-]" out.csv | sed -n 3p)" -0.025 1e-9
}

@test "the probe radius is one diameter where not given, and the table the same on one thread and two" {
    "$synthetic_run" run.h5 frames=3
    "$TOMODEM_BIN/volume_change" run.h5 one.csv --threads 1 --json out.json
    [ "$(value probe_radius out.json)" = 1.0 ]
    "$TOMODEM_BIN/volume_change" run.h5 two.csv --threads 2
    cmp one.csv two.csv
}

@test "a probe that passes everywhere is refused" {
    "$synthetic_run" run.h5
    fails 1 "frame 0: a ball of 0.1 mm passes between all" "$TOMODEM_BIN/volume_change" run.h5 out.csv --probe-radius 0.1mm
}

@test "a probe radius without a unit is wrong usage" {
    "$synthetic_run" run.h5
    fails 2 "--probe-radius" "$TOMODEM_BIN/volume_change" run.h5 out.csv --probe-radius 1
}
