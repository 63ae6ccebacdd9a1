#!/usr/bin/env bats
load common

@test "a relaxed sample is pressed to the target strain, with frames, curves and every particle" {
    make_sample sample.h5
    make_scene scene.toml -0.1
    relax sample.h5 scene.toml relaxed.h5 --quiet
    solve relaxed.h5 scene.toml run.h5 --json run.json --quiet
    /usr/bin/python3 - <<'END'
import h5py, json
import numpy as np

run = h5py.File("run.h5")
position = run["particles/all/position/value"]
assert position.shape == (5, 500, 3), position.shape
strain = run["observables/strain/value"][:]
assert np.isclose(strain[-1], -0.1) and np.all(np.diff(strain) < 0)
names = {"strain", "stress_true", "stress_engineering", "force_top", "force_bottom", "equilibrium_error",
         "kinetic_energy", "potential_energy", "section"}
assert names == set(run["observables"]), set(run["observables"])
assert run["observables/stress_true"].attrs["unit"] in ("Pa", b"Pa")
true, engineering = (run[f"observables/{n}/value"][:] for n in ("stress_true", "stress_engineering"))
assert np.allclose(engineering, true * np.exp(-strain))
section = run["observables/section/value"][:]
force = (run["observables/force_top/value"][:] - run["observables/force_bottom/value"][:]) / 2
assert np.allclose(true, force / section)
assert true[-1] < -1e7, true[-1]
summary = json.load(open("run.json"))
assert summary["particles"] == 500 and summary["particles_lost"] == 0
for key in ("time_step", "steps", "cpu_seconds", "seconds_per_particle_step", "peak_bytes"):
    assert summary[key] > 0, key
END
}

@test "a sample that is not relaxed is relaxed first, and says so" {
    make_sample sample.h5
    make_scene scene.toml -0.02
    run solve sample.h5 scene.toml run.h5
    [ "$status" -eq 0 ]
    [[ "$output" == *"it is relaxed before the load"* ]]
}

@test "two processes give the stress of one, and keep every particle" {
    make_sample sample.h5 2000
    make_scene scene.toml -0.3
    relax sample.h5 scene.toml relaxed.h5 --quiet
    solve relaxed.h5 scene.toml one.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml two.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

stress, curves = [], []
for name in ("one.h5", "two.h5"):
    run = h5py.File(name)
    assert run["particles/all/position/value"].shape[1] == 2000
    assert np.isfinite(run["particles/all/position/value"][-1]).all()
    strain, value = run["observables/strain/value"][:], run["observables/stress_true/value"][:]
    curves.append(value)
    stress.append(value[(strain < -0.25)].mean())
print("flow stress [MPa]:", np.array(stress) / 1e6, "difference", stress[1] / stress[0] - 1)
# The same to round-off until chaos sets in, and in the mean after it.
assert np.allclose(curves[0][:5], curves[1][:5], rtol=1e-3)
assert abs(stress[1] / stress[0] - 1) < 0.02
END
}

@test "the scalar loop and the vector kernel give the same curve at first, the same flow stress after" {
    make_sample sample.h5 1000
    make_scene scene.toml -0.2
    relax sample.h5 scene.toml relaxed.h5 --quiet
    TOMODEM_KERNEL=scalar solve relaxed.h5 scene.toml scalar.h5 --quiet
    TOMODEM_KERNEL=vector solve relaxed.h5 scene.toml vector.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

a, b = (h5py.File(f"{name}.h5")["observables/stress_true/value"][:] for name in ("scalar", "vector"))
assert np.allclose(a[:3], b[:3], rtol=1e-6), (a[:3], b[:3])
assert abs(b[-50:].mean() / a[-50:].mean() - 1) < 0.03
END
}

@test "the run holds what is needed to repeat it" {
    make_sample sample.h5
    make_scene scene.toml -0.02
    solve sample.h5 scene.toml run.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py, hashlib

parameters = h5py.File("run.h5")["parameters/tomodem"]
assert parameters["tool"].asstr()[()] == "solve"
assert "solve sample.h5 scene.toml run.h5" in parameters["command_line"].asstr()[()]
assert parameters["scene"].asstr()[()] == open("scene.toml").read()
inputs = dict(zip(parameters["inputs/name"].asstr()[:], parameters["inputs/sha256"].asstr()[:]))
for name in ("sample.h5", "scene.toml"):
    assert inputs[name] == hashlib.sha256(open(name, "rb").read()).hexdigest()
END
}

@test "--explain says what is on, why, and what a run will cost, and writes nothing" {
    make_sample sample.h5
    make_scene scene.toml -0.02
    relax sample.h5 scene.toml relaxed.h5 --quiet
    solve relaxed.h5 scene.toml run.h5 --explain --json explain.json | tee said.txt
    grep -qF 'bounded_attraction: off: law "bilin"' said.txt
    grep -qF 'relaxation_first: off' said.txt
    [ ! -e run.h5 ] && [ ! -e run.h5.partial ]
    solve relaxed.h5 scene.toml run.h5 --json run.json --quiet
    /usr/bin/python3 - <<'END'
import json
said, was = json.load(open("explain.json")), json.load(open("run.json"))
assert said["steps"] == was["steps"], (said["steps"], was["steps"])
assert said["time_step"] == was["time_step"]
assert said["predicted_wall_seconds"] > 0
END
}
