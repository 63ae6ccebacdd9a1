bats_require_minimum_version 1.5.0
load ../metrics/common

setup() {
    cd "$BATS_TEST_TMPDIR"
    pores=$TOMODEM_BIN/pores
}

# phantom EXPRESSION: sample.h5, a cube of 100^3 voxels of 1 um filled where the condition of x, y, z (-1 to 1) does not hold.
phantom() {
    /usr/bin/python3 - "$1" <<'PYTHON'
import sys, h5py, numpy as np
at = (np.arange(100) + 0.5) / 50 - 1
z, y, x = at[:, None, None], at[None, :, None], at[None, None, :]
pore = np.broadcast_to(eval(sys.argv[1]), (100, 100, 100))
with h5py.File("image.h5", "w") as file:
    file["labels"] = np.where(pore, 0, 1).astype(np.uint8)
print(pore.sum() * 1e-9)
PYTHON
    [ -e "$BATS_FILE_TMPDIR/brick.h5" ] ||
        "$TOMODEM_BIN/packgen" "$BATS_FILE_TMPDIR/brick.h5" --particles 20000 --density 0.64 --quiet
    "$TOMODEM_BIN/vol2pack" "$BATS_FILE_TMPDIR/brick.h5" image.h5:/labels sample.h5 --voxel-size 1um --pixels-per-seed 2 --quiet
}

@test "a closed pore has its volume, no mouth and the sphericity of a ball, and VTK opens its mesh" {
    truth=$(phantom "x**2 + y**2 + z**2 < 0.25")
    "$pores" sample.h5 table.csv --each each.csv --json out.json
    [ "$(value pores out.json)" -eq 1 ]
    [ "$(value open_pores out.json)" -eq 0 ]
    close "$(value volume_corrected out.json)" "$truth" 0.03
    close "$(value porosity out.json)" 0.0654 0.02
    /usr/bin/python3 - <<'PYTHON'
import csv
row = next(csv.DictReader(open("each.csv")))
assert abs(float(row["sphericity [-]"]) - 1) < 0.03, row
assert all(abs(float(row[f"centre_{axis} [mm]"]) - 0.05) < 0.0015 for axis in "xyz"), row
PYTHON
    "$TOMODEM_BIN/mesh_recon" sample.h5 pore.vtp --pores --quiet
    "$TOMODEM_BIN/mesh_recon" sample.h5 under_lid.vtp --pores --lid-radius 200um --quiet
    /usr/bin/python3 - <<'PYTHON'
import vtk
volumes = []
for name in ("pore.vtp", "under_lid.vtp"):
    reader = vtk.vtkXMLPolyDataReader(); reader.SetFileName(name)
    mass = vtk.vtkMassProperties(); mass.SetInputConnection(reader.GetOutputPort())
    volumes.append(mass.GetVolume())
assert volumes[0] > 0 and abs(volumes[1] / volumes[0] - 1) < 1e-9, volumes
PYTHON
}

@test "a pore with a mouth has its volume under a lid, and is none without" {
    truth=$(phantom "x**2 + y**2 + (z - 0.6)**2 < 0.25")
    "$pores" sample.h5 table.csv --json open.json
    [ "$(value pores open.json)" -eq 1 ]
    [ "$(value open_pores open.json)" -eq 1 ]
    close "$(value volume_corrected open.json)" "$truth" 0.05
    "$pores" sample.h5 table.csv --closed-only --json closed.json
    [ "$(value pores closed.json)" -eq 0 ]
    [ "$(value volume closed.json)" = 0.0 ]
    "$TOMODEM_BIN/mesh_recon" sample.h5 pore.stl --pores --lid-radius 100um --json mesh.json
    [ "$(value components mesh.json)" -eq 1 ]
}

@test "each pore of ten particles across or more has the volume and sphericity of its voxels by marching cubes" {
    local measure="$TOMODEM_SOURCE/tests/tools/mesh_recon/against_marching_cubes.py"
    /usr/bin/python3 "$measure" image 1 image.h5
    for density in 0.64 0.70; do
        "$TOMODEM_BIN/packgen" brick.h5 --particles 20000 --density $density --quiet
        "$TOMODEM_BIN/vol2pack" brick.h5 image.h5:/labels sample.h5 --voxel-size 1um --pixels-per-seed 1 --quiet 2>/dev/null
        "$pores" sample.h5 table.csv --each each.csv --quiet
        /usr/bin/python3 "$measure" compare image.h5 1e-3 each.csv
    done
}

# walls WIDTH ...: run.h5, a hollow cube of particles with a window of that width in its upper face, wider from frame to frame.
walls() {
    /usr/bin/python3 - "$@" <<'PYTHON'
import sys, h5py, numpy as np
at = np.arange(18.0)
x, y, z = (c.ravel() for c in np.meshgrid(at, at, at, indexing="ij"))
shell = np.minimum.reduce([x, y, z, 17 - x, 17 - y, 17 - z]) < 1.5
window = (np.abs(x - 8.5) < 3) & (np.abs(y - 8.5) < 3) & (z > 15)
first = np.stack([x, y, z], axis=1)[shell & ~window]
first += np.random.default_rng(1).uniform(-0.05, 0.05, first.shape)
frames = []
for width in map(float, sys.argv[1:]):
    moved = first.copy()
    top = moved[:, 2] > 15
    for c in (0, 1):  # the upper face is pushed apart from its middle
        moved[top, c] += np.sign(moved[top, c] - 8.5) * (width - 7) / 2
    frames.append(moved)
with h5py.File("run.h5", "a") as file:
    particles = file["particles/all"]
    for name in ("id", "species"):
        del particles[name]
    particles["id"], particles["species"] = np.arange(1, len(first) + 1), np.ones(len(first), np.int32)
    for name in list(particles["position"]):
        del particles["position"][name]
    particles["position/value"], particles["position/step"] = np.stack(frames), np.arange(len(frames))
    particles["position/time"] = np.arange(len(frames), dtype=float)
    for name in list(file["observables"]):
        del file["observables"][name]
    curve = file.create_group("observables/strain")
    curve["value"], curve["step"] = np.linspace(0, -0.02, len(frames)), np.arange(len(frames))
    curve["time"] = np.arange(len(frames), dtype=float)
    curve.attrs["unit"] = ""
PYTHON
}

@test "a lid that falls into the structure between two frames is a warning, and the advice in it helps" {
    "$synthetic_run" run.h5 cells=6
    walls 7 7.4 8.2 8.6
    run --separate-stderr "$pores" run.h5 table.csv --lid-radius 3.9mm
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"between frames 1 and 2 the volume of the pores goes from"*"give a larger --lid-radius"* ]]
    run --separate-stderr "$pores" run.h5 table.csv --lid-radius 6mm
    [ -z "$stderr" ]
    # Without the option: one lid for all frames, of the first.
    run --separate-stderr "$pores" run.h5 table.csv --json out.json
    [ -z "$stderr" ]
    close "$(value lid_radius out.json)" 8.5 0.01
    "$pores" run.h5 last.csv --frames last --json last.json --quiet
    [ "$(tail -1 last.csv)" = "$(tail -1 table.csv)" ]
}

@test "a solid has no pores, whatever the roughness of its faces; two probes see it" {
    phantom "x > 2"
    "$pores" sample.h5 table.csv --json out.json
    [ "$(value pores out.json)" -eq 0 ]
    [ "$(value porosity out.json)" = 0.0 ]
    run --separate-stderr "$pores" sample.h5 table.csv --method two-probes --json probes.json
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"roughness"* ]]
    /usr/bin/python3 -c "assert $(value volume probes.json) > 0.02e-3"
}

@test "the thesis' outward vectors wrap the wall of a pore in a relaxed sample" {
    truth=$(phantom "x**2 + y**2 + z**2 < 0.25")
    cat > scene.toml <<'SCENE'
seed_radius = 0.5
[phase.solid]
label = 1
law = "bilin"
norton = { K = 95.9, M = 2.45e-3 }
[load]
axis = "z"
steps = [ { strain = -0.1, rate = 1e-3 } ]
SCENE
    "$TOMODEM_BIN/relax" sample.h5 scene.toml relaxed.h5 --quiet
    "$pores" relaxed.h5 table.csv --method outward-vectors --each each.csv --quiet
    # Most of the wall, with holes like a sieve.
    /usr/bin/python3 - "$truth" <<'PYTHON'
import csv, sys
row = next(csv.DictReader(open("each.csv")))
assert 0.7 < float(row["volume [mm^3]"]) / float(sys.argv[1]) < 1.6, row
assert all(abs(float(row[f"centre_{axis} [mm]"]) - 0.05) < 0.003 for axis in "xyz"), row
PYTHON
}

@test "the same pores on any number of threads" {
    "$synthetic_run" run.h5 cells=8
    "$pores" run.h5 one.csv --threads 1 --quiet
    "$pores" run.h5 two.csv --threads 2 --quiet
    cmp one.csv two.csv
}

@test "what cannot be measured is refused in one line" {
    "$synthetic_run" run.h5
    fails 2 "goes with --method two-probes only" "$pores" run.h5 out.csv --closed-frame 0
    fails 2 "goes with --method outward-vectors only" "$pores" run.h5 out.csv --min-outward 1mm
    fails 2 "one volume for all pores" "$pores" run.h5 out.csv --method two-probes --each each.csv
    fails 2 "exclude each other" "$pores" run.h5 out.csv --closed-only --lid-radius 3mm
    fails 2 "--probe-radius" "$pores" run.h5 out.csv --probe-radius 0mm
    fails 1 "frame 0: the probe radius 99 mm is larger" "$pores" run.h5 out.csv --probe-radius 99mm
    fails 1 "a lid of 1 mm is too small" "$pores" run.h5 out.csv --lid-radius 1mm
    fails 1 "--closed-frame 99: the run has frames" "$pores" run.h5 out.csv --method two-probes --closed-frame 99
    fails 2 "--lid-radius goes with --pores only" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --lid-radius 3mm
}
