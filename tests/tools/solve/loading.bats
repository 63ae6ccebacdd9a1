#!/usr/bin/env bats
# Rates that change, and triangulated surfaces as walls.
load common

# load_with LINES: phase A and a [load] of its own
load_with() { make_scene scene.toml -0.1; sed -i "s|^steps = .*|$1|" scene.toml; }

@test "a polynomial rate is followed: strain against time, and the target" {
    make_sample sample.h5
    load_with 'steps = [ { strain = -0.05, rate = [5e-3, 2e-3] } ]'
    solve sample.h5 scene.toml run.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
strain = h5py.File("run.h5")["observables/strain"]
value, time = strain["value"][:], strain["time"][:]
assert np.allclose(value, -(5e-3 * time + 1e-3 * time**2), rtol=2e-3), value
assert np.isclose(value[-1], -0.05, rtol=1e-12)
assert np.all(np.abs(np.diff(value) + 1e-3) < 1e-4)
END
}

@test "a rate that falls to zero before the target" {
    make_sample sample.h5
    load_with 'steps = [ { strain = -0.05, rate = [1e-3, -1e-5] } ]'
    sed -i 's/-0.05/-0.3/' scene.toml
    refuses 1 "line 8: the rate falls to zero after 100 s, at strain -0.05" solve sample.h5 scene.toml run.h5
}

# The sample stands on a die; a tool comes down on it. Heights of the bare sample from its file.
press_between_plates() {
    make_sample sample.h5
    make_scene plain.toml -0.1
    relax sample.h5 plain.toml relaxed.h5 --quiet
    read -r low high < <(/usr/bin/python3 -c '
import h5py
z = h5py.File("relaxed.h5")["particles/all/position/value"][0, :, 2]
print(z.min() - 0.5, z.max() + 0.5)')
    mkdir -p surfaces
    make_plate surfaces/die.stl "$low"
    make_plate surfaces/tool.stl "$high"
    load_with 'duration = "12 s"\nrate = 1e-2'
    sed -i 's/\\n/\n/' scene.toml
    cat >> scene.toml <<'END'
[[wall]]
name = "die"
surface = "surfaces/die.stl"
[[wall]]
name = "tool"
surface = "surfaces/tool.stl"
velocity = [0, 0, -0.08]
stop = "10 s"
END
}

@test "a tool and a die press the sample, and feel opposite forces, on one process as on two" {
    press_between_plates
    solve relaxed.h5 scene.toml one.h5 --json one.json --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml two.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py, json, numpy as np
force = {}
for name in ("one", "two"):
    curves = h5py.File(f"{name}.h5")["observables"]
    assert "stress_true" not in curves and curves["strain/value"][-1] > 0.119
    force[name] = {wall: np.array([curves[f"wall_{wall}_force_{axis}/value"][:] for axis in "xyz"])
                   for wall in ("die", "tool")}
    time = curves["strain/time"][:]
die, tool = force["one"]["die"], force["one"]["tool"]
late = (time > 5) & (time < 10)
assert tool[2][late].mean() < -1e8 and die[2][late].mean() > 1e8, (tool[2][late].mean(), die[2][late].mean())
assert abs(tool[2][late].mean() / die[2][late].mean() + 1) < 0.01
# Smooth plates have no friction.
assert np.abs(tool[:2]).max() < 1e-9 * np.abs(tool[2]).max()
for wall in ("die", "tool"):
    assert np.allclose(force["one"][wall][2][:5], force["two"][wall][2][:5], rtol=1e-6, atol=1)
    assert abs(force["two"][wall][2][late].mean() / force["one"][wall][2][late].mean() - 1) < 0.05
assert "final_stress" not in json.load(open("one.json"))
END
}

@test "walls that are not there, cut, or inside the sample" {
    press_between_plates
    sed -i 's|surfaces/tool.stl|surfaces/none.stl|' scene.toml
    refuses 1 "line 17: wall 'tool': " solve relaxed.h5 scene.toml run.h5
    sed -i 's|surfaces/none.stl|surfaces/tool.stl|' scene.toml
    head -c 1000 surfaces/tool.stl > cut.stl && mv cut.stl surfaces/tool.stl
    refuses 1 "line 17: wall 'tool': " solve relaxed.h5 scene.toml run.h5
    make_plate surfaces/tool.stl 4
    refuses 1 "particles are nearer than half a seed radius" solve relaxed.h5 scene.toml run.h5
}

@test "periodic sides: no stress across the load, a section that is the box's, the same on two processes" {
    make_sample sample.h5 1000
    load_with 'lateral = "periodic"\nsteps = [ { strain = -0.15, rate = 1e-2 } ]'
    relax sample.h5 scene.toml relaxed.h5 --quiet
    solve relaxed.h5 scene.toml one.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" relaxed.h5 scene.toml two.h5 --quiet
    sed 's/"periodic"/"isochoric"/' scene.toml > isochoric.toml
    solve relaxed.h5 isochoric.toml isochoric.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py, numpy as np
curve = lambda name, what: h5py.File(f"{name}.h5")[f"observables/{what}/value"][:]
for what in ("stress_true", "section"):
    assert np.allclose(curve("one", what)[:20], curve("two", what)[:20], rtol=1e-6, atol=1)
strain, section = curve("isochoric", "strain"), curve("isochoric", "section")
assert np.allclose(section * np.exp(strain), section[0], rtol=1e-9)
# The sample fills the hollows of its rough ends: its sides come in, and it carries more than one that they hold open.
assert 0.85 < curve("one", "section")[-1] * np.exp(-0.15) / section[0] < 0.99
assert curve("one", "stress_true")[-20:].mean() < 1.5 * curve("isochoric", "stress_true")[-20:].mean() < 0
END
}

@test "periodic sides of a sample that has none" {
    make_sample sample.h5
    make_scene plain.toml -0.1
    relax sample.h5 plain.toml relaxed.h5 --quiet
    load_with 'lateral = "periodic"\nsteps = [ { strain = -0.15, rate = 1e-2 } ]'
    refuses 1 "line 7: periodic sides in [load]: the sample's box is not periodic along x" solve relaxed.h5 scene.toml run.h5
}
