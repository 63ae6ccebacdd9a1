#!/usr/bin/env bats
# The thesis' phases A and B: 5,000 particles at D = 0.70, 1e-3 /s to strain 0.35, three packings.
# t0 and the time step are ten times cheaper than the thesis', at the same rate t0^2 / time_step (docs/method.md).

setup_file() {
    export PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_FILE_TMPDIR" || exit 1
    for seed in 1 2 3; do packgen "brick$seed.h5" --particles 5000 --density 0.70 --random-seed $seed --quiet; done
}

setup() { cd "$BATS_FILE_TMPDIR" || exit 1; }

# press NAME K_REP T0: all three packings, two at a time
press() {
    cat > "$1.toml" <<END
[phase.$1]
label = 1
law = "bilin"
repulsive_stiffness = $2
natural_period = $3
[load]
steps = [ { strain = -0.35, rate = 1e-3 } ]
[accuracy]
time_step = 5e-3
frames = 7
END
    seq 3 | xargs -P 2 -I{} sh -ec "relax brick{}.h5 $1.toml $1{}.relaxed.h5 --quiet
        solve $1{}.relaxed.h5 $1.toml $1{}.h5 --quiet
        volume_change $1{}.h5 $1{}.volume.csv --quiet"
}

@test "phase A flows at 94 MPa within 10 %, in equilibrium within 0.2 %, keeping its volume within 8 %" {
    press a 6.23e9 0.1
    "$TOMODEM_SOURCE/tests/physics/flow_stress.py" 94 0.10 a?.h5 >&3
}

@test "phase B flows at 170 MPa within 10 %, in equilibrium within 0.2 %, keeping its volume within 8 %" {
    press b 2.65e9 2.53
    "$TOMODEM_SOURCE/tests/physics/flow_stress.py" 170 0.10 b?.h5 >&3
}
