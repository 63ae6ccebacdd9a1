synthetic_run="$TOMODEM_BIN/../tests/synthetic_run"

setup() {
    cd "$BATS_TEST_TMPDIR"
}

# value KEY FILE.json: one number of a summary
value() {
    /usr/bin/python3 -c 'import json, sys; print(json.load(open(sys.argv[2]))[sys.argv[1]])' "$1" "$2"
}

# close ACTUAL EXPECTED RELATIVE
close() {
    /usr/bin/python3 - "$@" <<'PYTHON'
import sys
actual, expected, relative = map(float, sys.argv[1:])
if not abs(actual - expected) <= relative * abs(expected):
    sys.exit(f"{actual} is not {expected} to {relative}")
PYTHON
}

# column NAME FILE.csv: the values under a header
column() {
    /usr/bin/python3 -c '
import csv, sys
for row in csv.DictReader(open(sys.argv[2])):
    print(row[sys.argv[1]])' "$1" "$2"
}

# fails STATUS TEXT COMMAND...: one line of error that holds TEXT, and no output file
fails() {
    local status_wanted="$1" text="$2"
    shift 2
    run --separate-stderr "$@"
    [ "$status" -eq "$status_wanted" ] || { echo "status $status: $stderr"; return 1; }
    [ "$(wc -l <<<"$stderr")" -eq 1 ] || { echo "more than one line: $stderr"; return 1; }
    [[ "$stderr" == *"$text"* ]] || { echo "'$text' is not in: $stderr"; return 1; }
    [ ! -e out.csv ] || { echo "out.csv was written"; return 1; }
    [ -z "$(find . -name '.*part*')" ] || { echo "a partial file stayed"; return 1; }
}

# refused STATUS TEXT COMMAND...: as fails, for outputs of any name: nothing new is in the folder
refused() {
    local before
    before=$(ls -A --ignore='separate-stderr-*')
    fails "$@"
    [ "$(ls -A --ignore='separate-stderr-*')" = "$before" ] || { echo "a file was written: $(ls -A)"; return 1; }
}
