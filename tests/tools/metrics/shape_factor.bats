bats_require_minimum_version 1.5.0
load common

@test "a sphere under isochoric compression has S_f = exp(1.5 strain)" {
    "$synthetic_run" run.h5 objects=1 cells=14 strain=0.3 frames=4
    "$TOMODEM_BIN/shape_factor" run.h5 out.csv --exclude-boundary --means means.csv --json out.json
    [ "$(value objects_used out.json)" -eq 1 ]
    [ "$(value objects_too_small out.json)" -eq 1 ]
    [ "$(value objects_at_boundary out.json)" -eq 1 ]
    close "$(value shape_factor_first out.json)" 1 1e-2
    close "$(value shape_factor_last_normalised out.json)" 0.6376281516 1e-9
    [ "$(column "frame [-]" out.csv | tr '\n' ' ')" = "0 1 2 3 " ]
    close "$(column "strain [-]" out.csv | tail -1)" -0.3 1e-9
    close "$(column "shape_factor_normalised [-]" out.csv | tail -1)" 0.6376281516 1e-9
    close "$(column "normalised_plain [-]" means.csv | tail -1)" 0.6376281516 1e-9
    [ "$(column "deviation_plain [-]" means.csv | tail -1)" = "" ]
}

@test "every object large enough has a row in every frame, and the means are over them" {
    "$synthetic_run" run.h5 objects=1 cells=14 frames=3
    "$TOMODEM_BIN/shape_factor" run.h5 out.csv --means means.csv --json out.json
    [ "$(column "object [-]" out.csv | tr '\n' ' ')" = "1 2 1 2 1 2 " ]
    /usr/bin/python3 -c '
import csv, json, statistics
rows = [r for r in csv.DictReader(open("out.csv")) if r["frame [-]"] == "2"]
s = [float(r["shape_factor [-]"]) for r in rows]
n = [float(r["particles [-]"]) for r in rows]
last = json.load(open("out.json"))["shape_factor_frames"][2]
assert abs(last["mean_plain"] - statistics.mean(s)) < 1e-9
assert abs(last["deviation_plain"] - statistics.stdev(s)) < 1e-9
assert abs(last["mean_weighted"] - (s[0] * n[0] + s[1] * n[1]) / sum(n)) < 1e-9'
}

@test "a sample without objects is refused" {
    "$synthetic_run" run.h5
    fails 1 "no objects" "$TOMODEM_BIN/shape_factor" run.h5 out.csv
}

@test "a choice that leaves no object is refused" {
    "$synthetic_run" run.h5 objects=1 cells=14
    fails 1 "none of the 3 objects" "$TOMODEM_BIN/shape_factor" run.h5 out.csv --min-particles 1e6
}
