#!/usr/bin/env bats
# carve on a casting with pores and on real nodules read as pores: docs/relaxation.md.

setup() { cd "$BATS_TEST_TMPDIR" || exit 1; }

# check CASE JSON
check() {
    /usr/bin/python3 - "$1" <<'END' >&3
import json
import sys

result = json.load(open("figures.json"))[f"{sys.argv[1]}, bilin"]
carve, once = result["carve"], result["once"]
print(f"# {sys.argv[1]}: carve {carve}, once {once}")
assert abs(carve["total"]) <= 0.02 and abs(carve["grid"]) <= 0.03, "total volume"
assert carve["judged"] > 0 and abs(carve["worst"]) <= 0.05, "worst pore above 12 particles across"
assert carve["iou"] > 0.85, "intersection over union"
assert abs(carve["total"]) < abs(once["total"]), "no better than masking once"
END
}

@test "20 pores of a phantom casting have their volumes within 5 %, 2 % together, and overlap the image's by 0.85" {
    "$TOMODEM_SOURCE/bench/relax/carve.py" "$TOMODEM_BIN" --case phantom --json figures.json
    check phantom
}

@test "so do the nodules of a real cast iron, read as pores" {
    data=${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/data/nodular_cast_iron/labels
    [ -d "$data" ] || skip "the cast iron is not there: $data"
    "$TOMODEM_SOURCE/bench/relax/carve.py" "$TOMODEM_BIN" --case iron --iron "$data" --json figures.json
    check iron
}
