#!/usr/bin/env bats

@test "the commands of docs/tutorial.md lead from a stack to a report, as they stand there" {
    cd "$BATS_TEST_TMPDIR"
    export PATH="$TOMODEM_BIN:$PATH"
    sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$TOMODEM_SOURCE/docs/tutorial.md" > commands.sh
    [ "$(grep -c . commands.sh)" -gt 20 ]
    bash -eu commands.sh
    for made in curve.csv shapes.csv volume.csv before.png after.png report.html; do
        [ -s "tutorial/$made" ]
    done
    # What the page says of the result.
    /usr/bin/python3 - <<'END'
import csv
import json
import math

last = lambda name: list(csv.DictReader(open(f"tutorial/{name}")))[-1]
stress = float(last("curve.csv")["abs_stress_true [Pa]"]) / 1e6
shape = float(last("mean_shape.csv")["shape_factor_weighted [-]"])
volume = float(last("volume.csv")["volume_change [-]"])
print(stress, shape, volume)
assert abs(stress - 108) < 5 and abs(shape - 0.757) < 0.02 and abs(volume + 0.0226) < 0.005
END
}
