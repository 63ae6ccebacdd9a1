bats_require_minimum_version 1.5.0
load common

# part KEY.KEY... FILE.json: a value inside a JSON file
part() {
    /usr/bin/python3 -c '
import functools, json, sys
find = lambda value, key: value[int(key) if key.isdigit() else key]
print(functools.reduce(find, sys.argv[1].split("."), json.load(open(sys.argv[2]))))' "$1" "$2"
}

@test "a measure that is one source in a folder of measures runs, and declares how pages show it" {
    height="$TOMODEM_BIN/../tests/measures/height"
    "$synthetic_run" run.h5 strain=0.3 frames=4
    "$height" run.h5 height.csv --json height.json
    [ "$(column "height [mm]" height.csv | wc -l)" = 4 ]
    close "$(value height_last height.json)" "$(/usr/bin/python3 -c 'from math import exp; print(6 * exp(-0.3) + 1)')" 1e-9
    "$height" --describe >described.json
    [ "$(part display.heading described.json)" = "Height of the sample" ]
    [ "$(part display.results.0.factor described.json)" = 1000.0 ]
    [ "$(part display.x.key described.json)" = strain ]
    [ "$(part display described.json)" = "$(part display height.json)" ]
}

@test "every source in a folder of measures is a tool that declares its display, and is called as TOOL RUN TABLE" {
    sources=("$TOMODEM_SOURCE"/tools/{metrics/*,mesh_recon}/measures/*.cpp)
    [ "${#sources[@]}" -ge 10 ]
    for source in "${sources[@]}"; do
        name=$(basename "$source" .cpp)
        echo "$name"
        "$TOMODEM_BIN/$name" --describe >described.json
        [ "$(part name described.json)" = "$name" ]
        [ "$(part step described.json)" = measure ]
        [ -n "$(part display.heading described.json)" ]
        [ "$(part arguments.0.name described.json) $(part arguments.1.name described.json)" = "RUN TABLE" ]
        [ "$(part arguments.1.formats described.json)" = "['.csv']" ]
    done
}

@test "the columns and results that a measure declares for pages are those that it writes" {
    "$synthetic_run" run.h5 objects=1 cells=12 frames=3
    for source in "$TOMODEM_SOURCE"/tools/metrics/{curves,shapes}/measures/*.cpp; do
        name=$(basename "$source" .cpp)
        "$TOMODEM_BIN/$name" run.h5 "$name.csv" --json "$name.json" --quiet
        /usr/bin/python3 - "$name" <<'PYTHON'
import csv, json, sys
name = sys.argv[1]
summary = json.load(open(f"{name}.json"))
columns = [column.split(" [")[0] for column in next(csv.reader(open(f"{name}.csv")))]
display = summary["display"]
for one in [display["x"], *display["curves"]]:
    assert one["key"] in columns, (name, one["key"], columns)
shown = [one["key"] for one in display["results"] if one["key"] in summary]
assert shown and shown[0] in [one["key"] for one in display["results"][:2]], (name, display["results"][:2], list(summary))
PYTHON
    done
}
