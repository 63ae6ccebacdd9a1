#!/usr/bin/env bats
# The pages of docs/recipes, as they stand there, and what they say of the results.

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    export PATH="$TOMODEM_BIN:$PATH"
}

# run_page NAME: the commands of a page
run_page() {
    sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$TOMODEM_SOURCE/docs/recipes/$1.md" >commands.sh
    [ "$(grep -c . commands.sh)" -gt 15 ]
    bash -eu commands.sh
}

# figure TABLE COLUMN: of its last row
figure() {
    /usr/bin/python3 -c 'import csv, sys
print(list(csv.DictReader(open(sys.argv[1])))[-1][sys.argv[2]])' "$@"
}

# between LOW VALUE HIGH
between() {
    /usr/bin/python3 -c 'import sys
low, value, high = map(float, sys.argv[1:])
print(value)
assert low <= value <= high' "$@"
}

@test "docs/recipes/open_structure.md leads from a noisy scan of fibres to a relative density and a stress" {
    run_page open_structure
    cd open_structure
    [ -s report.html ] && [ -s picture_after.png ]
    between 0.15 "$(figure density.csv 'relative_density [-]')" 0.25
    between 0 "$(figure stress.csv 'abs_stress_true [Pa]')" 60e3
    grep -q "Relative density" report.html
}

@test "docs/recipes/casting.md leads from a noisy scan of pores to their volume, which carve has kept" {
    run_page casting
    cd casting
    [ -s report.html ] && [ -s picture_after.png ]
    # The porosity of the phantom is 4 %, and falls to 2.6 %.
    /usr/bin/python3 -c 'import csv
rows = list(csv.DictReader(open("pores.csv")))
first, last = (100 * float(row["porosity [-]"]) for row in (rows[0], rows[-1]))
print(first, last)
assert abs(first - 4) < 0.2 and abs(last - 2.6) < 0.6 and rows[0]["pores [-]"] == "5"'
}

@test "docs/recipes/grains.md leads from a noisy scan of touching grains to the motion of each" {
    run_page grains
    cd grains
    [ -s report.html ] && [ -s picture_after.png ] && [ -s motion.h5 ]
    between 0.55 "$(figure density.csv 'relative_density [-]')" 0.62
    # Every grain of the phantom is one, and keeps its volume.
    /usr/bin/python3 -c 'import csv, json
truth = json.load(open("truth.json"))["objects"]
rows = [row for row in csv.DictReader(open("grains.csv")) if row["frame [-]"] == "0"]
assert len(rows) == len(truth) == 30, len(rows)
volumes, true = (sum(values) for values in ([float(row["volume [mm^3]"]) for row in rows], [one["volume_mm3"] for one in truth]))
print(volumes / true)
assert abs(volumes / true - 1) < 0.06'
}
