#!/usr/bin/env bats
# What docs/norton.md says of the law, by its benches, quasi-static, with few packings: half an hour on one core.

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    "$TOMODEM_SOURCE/bench/norton/tables.py" "$TOMODEM_BIN" --folder . --samples 2000x2 \
        --exponents 0.03 0.3 1 --jumps 10 1000 > tables.txt
    sed 's/^/# /' tables.txt >&3
    local reference="${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/reference"
    [ -d "$reference" ] || return 0
    "$TOMODEM_SOURCE/bench/norton/two_phases.py" "$TOMODEM_BIN" --folder . --reference "$reference" \
        --samples 2000x2 --rates 1e-4 1e-3 --balls 8000x1 > two_phases.txt
    sed 's/^/# /' two_phases.txt >&3
}

# holds NAME CONDITION: a Python expression of mean, the means over packings of the figures in NAME.json
holds() {
    /usr/bin/python3 - "$BATS_FILE_TMPDIR/$1.json" "$2" <<'END'
import json
import sys

mean = {key: value["mean"] for key, value in json.load(open(sys.argv[1])).items()}
exponents, loads = ("0.03", "0.3", "1"), ("compression", "tension")
for key, value in mean.items():
    print(f"{key}: {value:.4g}")
assert eval(sys.argv[2]), sys.argv[2]
END
}

beside_reference() {
    [ -f "$BATS_FILE_TMPDIR/two_phases.json" ] || skip "the finite-element reference is not there"
    holds two_phases "$1"
}

@test "M is the one asked for within 0.015 over three decades of rate, in compression and in tension" {
    holds tables 'all(abs(mean[f"fit {m} {load} planes"] - float(m)) < 0.015 for m in exponents for load in loads)'
}

@test "the flow stress at strain 0.3 is K rate^M within 5 % in compression, 8 % in tension" {
    holds tables 'all(abs(mean[f"one 2000 {m} {load} planes 0.3"] - 1) < bound
                      for m in exponents for load, bound in zip(loads, (0.05, 0.08)))'
}

@test "volume is kept within 2 % at a compression of 0.5, and within 5 % in tension" {
    holds tables 'all(abs(mean[f"one 2000 {m} {load} volume, alpha shape"]) < bound
                      for m in exponents for load, bound in zip(loads, (0.02, 0.05)))'
}

@test "a rate ten times or a thousand times as high is answered within 4 % after 0.05 of strain" {
    holds tables 'all(abs(mean[f"jump {factor} {m} planes 0.05"] - 1) < 0.04
                      for m in exponents for factor in ("10", "1000"))'
}

@test "plane strain at 0.2 has the stress of Norton's tensor within 10 %" {
    holds tables 'all(abs(mean[f"plane 2000 {m} compression planes 0.2"] - 1) < 0.10 for m in exponents)'
}

@test "two phases carry the stress of the finite elements within 8 %, and the inclusion's shape is theirs within 8 %" {
    beside_reference 'all(abs(mean[f"{case} {rate} 2000 planes"]) < 0.08 for case in ("parallel", "series", "inclusion")
                          for rate in ("0.0001", "0.001"))'
    beside_reference 'all(abs(mean[f"inclusion {rate} 2000 shape"]) < 0.08 for rate in ("0.0001", "0.001"))'
}

@test "balls in a linear matrix keep the shape of the finite elements within 3 %, and of the exact answer at 0.3 within 5 %" {
    beside_reference 'all(abs(mean[f"ball {r} {share} 8000 {at}"]) < 0.03
                          for r in ("5", "0.2") for share in ("0.04", "0.01") for at in ("0.1", "0.2", "0.3"))'
    beside_reference 'all(abs(mean[f"spheroid {r} {share} 8000 0.3"]) < 0.05 for r in ("2", "10") for share in ("0.01", "0.004"))'
}
