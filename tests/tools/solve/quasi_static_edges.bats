#!/usr/bin/env bats
# The quasi-static scheme of law NORTON at its edges: periodic sides, jumps of the rate, a tight balance, a killed run.
load common

# flow_scene FILE M LATERAL STEPS [ACCURACY]
flow_scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "norton"
norton = { K = 100, M = $2 }
[load]
lateral = "$3"
steps = [ $4 ]
[accuracy]
frames = 3
$5
[output]
stress = true
END
}

make_flow_brick() { packgen brick.h5 --particles "$1" --density 0.64 --quiet; }

@test "periodic sides carry no mean stress, and the stress does not swing" {
    make_flow_brick 500
    for m in 0.3 1; do
        flow_scene scene.toml $m periodic "{ strain = -0.12, rate = 1e-3 }"
        solve brick.h5 scene.toml run$m.h5 --quiet
    done
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
for m in ("0.3", "1"):
    run = h5py.File(f"run{m}.h5")
    stress = run["particles/all/stress/value"][1:].mean(axis=1)
    print(m, stress / stress[0, 2])
    assert (np.abs(stress[:, :2].mean(axis=1)) < 0.02 * np.abs(stress[:, 2])).all()
    true = run["observables/stress_virial/value"][4:]
    assert np.abs(np.diff(true)).max() < 0.05 * np.abs(true.mean())
END
}

@test "after a jump of the rate by 1,000 the stress is that of the new rate alone" {
    make_flow_brick 500
    flow_scene jump.toml 0.1 free "{ strain = -0.1, rate = 1e-3 }, { strain = -0.2, rate = 1e-6 }" "reference_rate = 1e-3"
    flow_scene alone.toml 0.1 free "{ strain = -0.2, rate = 1e-6 }" "reference_rate = 1e-3"
    relax brick.h5 jump.toml sample.h5 --quiet
    solve sample.h5 jump.toml jump.h5 --quiet
    solve sample.h5 alone.toml alone.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
jump, alone = (h5py.File(f"{name}.h5")["observables/stress_true/value"][-6:].mean() for name in ("jump", "alone"))
print(jump / alone)
assert abs(jump / alone - 1) < 0.02
END
}

@test "a balance ten times tighter is found in tension between planes that leave the sample free to turn" {
    make_flow_brick 500
    flow_scene scene.toml 0.3 free "{ strain = 0.3, rate = 1e-3 }" "max_imbalance = 1e-3"
    solve brick.h5 scene.toml run.h5 --quiet
}

@test "a run between periodic sides that is killed is gone on with bit by bit" {
    make_flow_brick 1500
    flow_scene scene.toml 0.3 periodic "{ strain = -0.15, rate = 1e-3 }, { strain = -0.3, rate = 1e-2 }"
    relax brick.h5 scene.toml sample.h5 --quiet
    solve sample.h5 scene.toml whole.h5 --quiet --checkpoint-every 0.0001
    solve sample.h5 scene.toml run.h5 --quiet --checkpoint-every 0.0001 &
    for _ in $(seq 400); do [ -e run.h5.checkpoint ] && break; sleep 0.02; done
    kill -9 $!
    wait $! || true
    [ ! -e run.h5 ]
    solve sample.h5 scene.toml run.h5 --quiet --resume
    /usr/bin/python3 - <<'END'
import h5py
a, b = h5py.File("whole.h5"), h5py.File("run.h5")
for name in ("observables/stress_true/value", "observables/section/value", "particles/all/position/value"):
    assert a[name][:].tobytes() == b[name][:].tobytes(), name
END
}
