#!/usr/bin/env bats
# BILIN in seconds: a small packing, large time steps (docs/method.md says why they give the same stress).

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
    packgen brick.h5 --particles 2000 --density 0.70 --quiet
}

# press NAME K_REP T0: 1e-3 /s to strain 0.35, 7000 steps
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
time_step = 0.05
frames = 1
END
    relax brick.h5 "$1.toml" "$1.relaxed.h5" --quiet
    solve "$1.relaxed.h5" "$1.toml" "$1.h5" --quiet
}

@test "phase A flows at 94 MPa within 15 %" {
    press a 6.23e9 1.0
    "$TOMODEM_SOURCE/tests/physics/flow_stress.py" 94 0.15 a.h5
}

@test "the flow stress is proportional to the stiffness" {
    press a 6.23e9 1.0
    press double 12.46e9 1.0
    "$TOMODEM_SOURCE/tests/physics/flow_stress.py" 188 0.15 double.h5
}

@test "a higher chi flows at a higher stress" {
    # g(chi): 0.0157 at 0.02, 0.0414 at 0.64
    press low 6.23e9 1.0
    press high 6.23e9 5.66
    /usr/bin/python3 - <<'END'
import h5py

def stress(name):
    run = h5py.File(name)["observables"]
    return run["stress_true/value"][run["strain/value"][:] < -0.25].mean()

ratio = stress("high.h5") / stress("low.h5")
print("ratio", ratio)
assert abs(ratio / (0.0414 / 0.0157) - 1) < 0.15
END
}
