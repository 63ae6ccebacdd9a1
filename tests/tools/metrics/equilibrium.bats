bats_require_minimum_version 1.5.0
load common

@test "a known difference of the forces comes out as the error" {
    "$synthetic_run" run.h5 equilibrium_error=0.002 slope=100
    "$TOMODEM_BIN/equilibrium" run.h5 out.csv --from 0.2 --to 0.3 --json out.json
    close "$(value equilibrium_error out.json)" 0.002 1e-9
    close "$(value equilibrium_error_max out.json)" 0.002 1e-9
    close "$(value abs_strain_from out.json)" 0.2 1e-9
    [ "$(head -1 out.csv)" = "time [s],strain [-],abs_strain [-],force_top [uN],force_bottom [uN],equilibrium_error [-]" ]
    close "$(column "equilibrium_error [-]" out.csv | sed -n 300p)" 0.002 1e-9
}

@test "points before the planes carry a force are left out" {
    "$synthetic_run" run.h5 K=0 slope=100 equilibrium_error=0.01
    "$TOMODEM_BIN/equilibrium" run.h5 out.csv --averaging-strain 0 --json out.json
    [ "$(value points_without_force out.json)" -eq 1 ]
    close "$(value equilibrium_error out.json)" 0.01 1e-6
}

@test "a range that the run does not cover is refused" {
    "$synthetic_run" run.h5 strain=0.1
    fails 1 "the largest is 0.0975; give other --from and --to" "$TOMODEM_BIN/equilibrium" run.h5 out.csv
}

@test "a run without forces is refused" {
    "$synthetic_run" run.h5 K=0
    fails 1 "zero in the whole run" "$TOMODEM_BIN/equilibrium" run.h5 out.csv
}
