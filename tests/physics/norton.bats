#!/usr/bin/env bats
# What docs/norton.md says of the law, by its benches, quasi-static, with few packings: half an hour on one core.

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    "$TOMODEM_SOURCE/bench/norton/tables.py" "$TOMODEM_BIN" --folder . --samples 2000x2 \
        --exponents 0.03 0.3 1 --jumps 10 1000 --parts one fit jump isochoric plane > tables.txt
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

@test "M is the one asked for within 0.01 over three decades of rate, in compression and in tension" {
    holds tables 'all(abs(mean[f"fit {m} {load} virial"] - float(m)) < 0.01 for m in exponents for load in loads)'
}

@test "the stress is K rate^M within 4 % at compressions of 0.1 to 0.5, within 2 % in tension to 0.3; planes and virial agree" {
    holds tables 'all(abs(mean[f"one 2000 {m} compression virial {at}"] - 1) < 0.04
                      for m in exponents for at in ("0.1", "0.2", "0.3", "0.4", "0.5"))'
    holds tables 'all(abs(mean[f"one 2000 {m} tension virial {at}"] - 1) < 0.02 for m in exponents for at in ("0.1", "0.2", "0.3"))'
    holds tables 'all(abs(mean[f"one 2000 {m} {load} planes {at}"] / mean[f"one 2000 {m} {load} virial {at}"] - 1) < 0.01
                      for m in exponents for load in loads for at in ("0.1", "0.2", "0.3"))'
}

@test "volume inside the material is kept within 2 % at 0.5" {
    holds tables 'all(abs(mean[f"one 2000 {m} {load} volume, inside"]) < 0.02 for m in exponents for load in loads)'
}

@test "a rate ten times as high is answered within 2 % after 0.05 of strain" {
    holds tables 'all(abs(mean[f"jump 10 {m} virial 0.05"] - 1) < 0.02 for m in exponents)'
}

@test "a rate a thousand times as high is answered within 2 % after 0.05 of strain" {
    holds tables 'all(abs(mean[f"jump 1000 {m} virial 0.05"] - 1) < 0.02 for m in exponents)'
}

@test "plane strain at 0.2 and 0.3 has the stress of Norton's tensor within 4 %" {
    holds tables 'all(abs(mean[f"plane 2000 {m} compression virial {at}"] - 1) < 0.04 for m in exponents for at in ("0.2", "0.3"))'
}

@test "uniform flow at constant volume has K rate^M within 4 % at 0.1 to 0.5" {
    holds tables 'all(abs(mean[f"isochoric 2000 {m} {load} {at}"] - 1) < 0.04
                      for m in exponents for load in loads for at in ("0.1", "0.2", "0.3", "0.4", "0.5"))'
}

@test "two phases carry the stress of the finite elements within 5 %, and the inclusion's shape is theirs within 3 %" {
    beside_reference 'all(abs(mean[f"{case} {rate} 2000 virial"]) < 0.05 for case in ("parallel", "series", "inclusion")
                          for rate in ("0.0001", "0.001"))'
    beside_reference 'all(abs(mean[f"inclusion {rate} 2000 shape"]) < 0.03 for rate in ("0.0001", "0.001"))'
}

@test "balls in a linear matrix keep the shape of the finite elements within 2.5 %, and of the exact answer within 3 %" {
    beside_reference 'all(abs(mean[f"ball {r} {share} 8000 {at}"]) < 0.025
                          for r in ("5", "0.2") for share in ("0.04", "0.01") for at in ("0.1", "0.2", "0.3"))'
    beside_reference 'all(abs(mean[f"spheroid {r} {share} 8000 {at}"]) < 0.03
                          for r in ("2", "10") for share in ("0.01", "0.004") for at in ("0.1", "0.3", "0.5"))'
}
