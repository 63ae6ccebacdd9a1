# What is written: no result lands in a file that promises another format, or on top of another result.
bats_require_minimum_version 1.5.0
load ../metrics/common

@test "a name that promises another format is refused before anything is done" {
    "$synthetic_run" run.h5
    fails 2 "TABLE 'table.h5': the name must end in .csv" "$TOMODEM_BIN/stress_strain" run.h5 table.h5
    fails 2 "FIELDS 'fields.csv': the name must end in .h5" "$TOMODEM_BIN/local_strain" run.h5 fields.csv
    fails 2 "--events 'events.png': the name must end in .csv" "$TOMODEM_BIN/topology" run.h5 table.csv --events events.png
    [ ! -e table.csv ]
    "$TOMODEM_BIN/stress_strain" run.h5 curve.dat --quiet
    [ -s curve.dat ]
}

@test "two results in one file are refused" {
    "$synthetic_run" run.h5
    fails 2 "TABLE and --events are both './both.csv'" "$TOMODEM_BIN/topology" run.h5 both.csv --events ./both.csv
    fails 2 "TABLE and --json are both 'both'" "$TOMODEM_BIN/stress_strain" run.h5 both --json both
    [ ! -e both.csv ]
}
