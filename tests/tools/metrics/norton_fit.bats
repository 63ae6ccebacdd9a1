bats_require_minimum_version 1.5.0
load common

@test "runs of an exact Norton law give back K and M" {
    for rate in 1e-4 3e-4 1e-3; do "$synthetic_run" "run$rate.h5" rate=$rate K=5020 M=0.49; done
    "$TOMODEM_BIN/norton_fit" run1e-4.h5 run3e-4.h5 run1e-3.h5 out.csv --at 0.3 --json out.json
    close "$(value K out.json)" 5020 1e-9
    close "$(value M out.json)" 0.49 1e-9
    close "$(value M_low out.json)" "$(value M_high out.json)" 1e-8
    [ "$(head -1 out.csv)" = "run,rate [1/s],flow_stress [MPa],fit [MPa],deviation [-]" ]
    close "$(column "flow_stress [MPa]" out.csv | tail -1)" 170.1 1e-3
    /usr/bin/python3 -c '
import json
rows = json.load(open("out.json"))["rows"]
assert [row["run"] for row in rows] == ["run1e-4.h5", "run3e-4.h5", "run1e-3.h5"] and abs(rows[2]["deviation"]) < 1e-9'
}

@test "two runs give no interval" {
    for rate in 1e-4 1e-3; do "$synthetic_run" "run$rate.h5" rate=$rate M=0.1; done
    run --separate-stderr "$TOMODEM_BIN/norton_fit" run1e-4.h5 run1e-3.h5 out.csv
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"no confidence interval"* ]]
    [[ "$output" != *M_low* ]]
}

@test "a run that ends before the strain is named" {
    "$synthetic_run" long.h5
    "$synthetic_run" short.h5 rate=1e-4 strain=0.1
    fails 1 "'short.h5': the strain does not get to 0.3" "$TOMODEM_BIN/norton_fit" long.h5 short.h5 out.csv
}

@test "one run, and runs of one rate, are refused" {
    "$synthetic_run" a.h5
    "$synthetic_run" b.h5 K=101
    fails 1 "at least two runs" "$TOMODEM_BIN/norton_fit" a.h5 out.csv
    fails 1 "different rates" "$TOMODEM_BIN/norton_fit" a.h5 b.h5 out.csv
}
