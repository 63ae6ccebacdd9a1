bats_require_minimum_version 1.5.0
load ../metrics/common

@test "a scripted run has its events at their strains and places" {
    "$synthetic_run" run.h5 cells=14 frames=6 strain=0.5
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy
with h5py.File("run.h5", "r+") as file:
    frames = file["/particles/all/position/value"]
    block = frames[0]
    away = 100 + 5 * block
    def without(*centres):
        points = block.copy()
        for centre in centres:
            hole = (abs(block - centre) < 1.5).all(axis=1)
            points[hole] = away[hole]
        return points
    split = block.copy()
    split[split[:, 2] > 7.5] += [0, 0, 4]
    script = [block, without((4, 7, 7)), without((4, 7, 7), (9, 7, 7)), without((4, 7, 7)), block, split]
    for k, points in enumerate(script):
        frames[k] = points
PYTHON
    "$TOMODEM_BIN/topology" run.h5 frames.csv --events events.csv --json out.json
    [ "$(column "b2 [-]" frames.csv | tr '\n' ' ')" = "0 1 2 1 0 0 " ]
    [ "$(column "b0 [-]" frames.csv | tr '\n' ' ')" = "1 1 1 1 1 2 " ]
    [ "$(column "event [-]" events.csv | tr '\n' ' ')" = "pore_opened pore_opened pore_closed pore_closed split " ]
    [ "$(column "frame [-]" events.csv | tr '\n' ' ')" = "1 2 3 4 5 " ]
    /usr/bin/python3 - <<'PYTHON'
import csv, json
rows = list(csv.DictReader(open("events.csv")))
for row, x, strain in zip(rows, (4, 9, 9, 4, 7), (0.1, 0.2, 0.3, 0.4, 0.5)):
    assert abs(float(row["x [mm]"]) - x) < 1e-6 and abs(float(row["y [mm]"]) - 7) < 1e-6, row
    assert abs(float(row["strain [-]"]) + strain) < 1e-9, row
assert abs(float(rows[-1]["z [mm]"]) - 7.5) < 1e-6
assert [e["event"] for e in json.load(open("out.json"))["events"]] == [r["event [-]"] for r in rows]
PYTHON
    "$TOMODEM_BIN/topology" run.h5 one.csv --events one_events.csv --threads 1
    cmp frames.csv one.csv
    cmp events.csv one_events.csv
}

@test "pores below the least size are counted and not followed" {
    "$synthetic_run" run.h5 cells=8 frames=2
    "$TOMODEM_BIN/topology" run.h5 frames.csv --events events.csv --min-pore 1000
    [ "$(wc -l <events.csv)" -eq 1 ]
}

@test "bad requests are refused with one line and no table" {
    "$synthetic_run" run.h5
    fails 1 "no particle of species 5" "$TOMODEM_BIN/topology" run.h5 out.csv --species 5
    fails 1 "frame 0: a ball of" "$TOMODEM_BIN/topology" run.h5 out.csv --probe-radius 0.1mm
    fails 1 "larger than the particles to wrap" "$TOMODEM_BIN/topology" run.h5 out.csv --probe-radius 15mm
    fails 2 "--probe-radius" "$TOMODEM_BIN/topology" run.h5 out.csv --probe-radius 0mm
    fails 2 "--min-particles" "$TOMODEM_BIN/topology" run.h5 out.csv --min-particles 1
}
