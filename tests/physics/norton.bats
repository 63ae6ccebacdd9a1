#!/usr/bin/env bats
# What docs/norton.md says of the law, by its bench: 2,000 particles, three packings.

setup_file() {
    cd "$BATS_FILE_TMPDIR" || exit 1
    local fem="${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/reference/fem"
    [ -d "$fem" ] && set -- --fem "$fem"
    "$TOMODEM_SOURCE/bench/norton/tables.py" "$TOMODEM_BIN" "$@" > tables.txt
    sed 's/^/# /' tables.txt >&3
}

# holds CONDITION: a Python expression of t, which holds mean, spread and values of every figure
holds() {
    /usr/bin/python3 - "$BATS_FILE_TMPDIR/norton_tables/tables.json" "$1" <<'END'
import json
import sys
from types import SimpleNamespace

t = {key: SimpleNamespace(**value) for key, value in json.load(open(sys.argv[1])).items()}
rates, exponents, loads = ("0.001", "0.0001", "1e-05"), ("0.1", "0.25", "0.5", "0.75", "1"), ("compression", "tension")
for key, value in t.items():
    print(f"{key}: {value.mean:.4g} +- {value.spread:.2g}")
assert eval(sys.argv[2]), sys.argv[2]
END
}

@test "M is the one asked for within 0.03 over two decades of rate, in compression and in tension" {
    holds 'all(abs(t[f"{m} {load} M"].mean - float(m)) < 0.03 for m in exponents for load in loads)'
}

@test "the flow stress is K rate^M within 5 % in compression, 8 % in tension, where a sample scatters" {
    holds 'all(abs(t[f"{m} compression {rate} ratio"].mean - 1) < 0.05 for m in exponents for rate in rates)'
    holds 'all(abs(t[f"{m} tension {rate} ratio"].mean - 1) < 0.08 for m in exponents for rate in rates)'
}

@test "tension over compression is between 0.85 and 1.15" {
    holds 'all(0.85 < t[f"{m} {rate} T/C"].mean < 1.15 for m in exponents for rate in rates)'
}

@test "volume is kept within 2 % at a compression of 0.5, and within 5 % in tension" {
    holds 'all(abs(t[f"{m} compression {end} volume"].mean) < 0.02 for m in exponents for end in ("fast", "slow"))'
    holds 'all(abs(t[f"{m} tension {end} volume"].mean) < 0.05 for m in exponents for end in ("fast", "slow"))'
}

@test "half the time step changes the stress by less than 1 %" {
    holds 'all(abs(t[f"{m} half"].mean) < 0.01 for m in exponents)'
}

@test "a rate three times as high is answered with M within 0.05" {
    holds 'all(abs(t[f"{m} jump"].mean - float(m)) < 0.05 for m in exponents)'
}

@test "two phases carry the stress of the finite elements within 7 %, and the inclusion's shape is theirs within 8 %" {
    [ -d "${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/reference/fem" ] || skip "the finite-element reference is not there"
    holds 'all(abs(t[f"norton {case} {rate} stress"].mean) < 0.07 for case in ("parallel", "series", "inclusion")
               for rate in ("0.0001", "0.001"))'
    holds 'all(abs(t[f"norton inclusion {rate} shape"].mean) < 0.08 for rate in ("0.0001", "0.001"))'
}
