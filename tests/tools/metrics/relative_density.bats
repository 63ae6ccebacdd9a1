bats_require_minimum_version 1.5.0
load common

# An open foam of struts of two to three particles, made, brought to rest and pressed once for all tests of this file.
setup_file() {
    cd "$BATS_FILE_TMPDIR"
    cat >scene.toml <<'SCENE'
seed_radius = 0.5
[phase.solid]
label = 1
law = "trilin"
norton = { K = 95.9, M = 0.0714 }
[load]
axis = "z"
steps = [ { strain = -0.3, rate = 1e-3 } ]
[accuracy]
frames = 6
SCENE
    "$TOMODEM_BIN/packgen" brick.h5 --particles 5000 --density 0.64 --quiet
    "$TOMODEM_BIN/phantom_foam" foam.tif --size 100 --voxel-size 10um --relative-density 0.25 --cells 2 --quiet
    "$TOMODEM_BIN/vol2pack" brick.h5 foam.tif sample.h5 --pixels-per-seed 2.5 --quiet
    "$TOMODEM_BIN/relax" sample.h5 scene.toml relaxed.h5 --quiet
    "$TOMODEM_BIN/solve" relaxed.h5 scene.toml run.h5 --quiet
}

setup() {
    cd "$BATS_TEST_TMPDIR"
    file=$BATS_FILE_TMPDIR
}

relative_density() {
    "$TOMODEM_BIN/relative_density" "$@"
}

@test "an open sample as cut has the relative density of its image" {
    relative_density "$file/sample.h5" out.csv --json out.json
    "$TOMODEM_BIN/volume_info" "$file/foam.tif" --json info.json --quiet
    /usr/bin/python3 -c "assert abs(100 * $(value relative_density out.json) - $(value fraction_label_1 info.json)) < 1"
    "$TOMODEM_BIN/packgen" dense.h5 --particles 3000 --density 0.70 --quiet
    relative_density dense.h5 out.csv --json out.json
    close "$(value relative_density out.json)" 1 0.01
    close "$(value relative_density_hull out.json)" 1 0.02
}

@test "real fibres down to half a particle thick have the relative density of their image" {
    shared=${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}
    image=$shared/data/polymer_fibres/fibres_labels.tif
    [ -e "$image" ] || skip "the tomography polymer_fibres is not there (TOMODEM_SHARED)"
    "$TOMODEM_BIN/volume_info" "$image" --voxel-size 10um --json info.json --quiet
    for density in 0.64 0.74; do
        "$TOMODEM_BIN/packgen" brick.h5 --particles 5000 --density $density --quiet
        "$TOMODEM_BIN/vol2pack" brick.h5 "$image" sample.h5 --voxel-size 10um --pixels-per-seed 2.5 --quiet 2>/dev/null
        relative_density sample.h5 out.csv --json out.json
        /usr/bin/python3 -c "assert abs(100 * $(value relative_density out.json) - $(value fraction_label_1 info.json)) < 1"
        # Under the hull of the sample, too, from which the corners of the image are missing.
        "$TOMODEM_BIN/pores" sample.h5 pores.csv --json pores.json --quiet
        /usr/bin/python3 -c "assert abs(100 * (1 - $(value porosity pores.json)) - $(value fraction_label_1 info.json)) < 1"
    done
}

@test "through a pressed foam it is that of the voxels of the particles, their gaps closed" {
    relative_density "$file/run.h5" out.csv
    /usr/bin/python3 - "$file/run.h5" <<'PYTHON'
import csv, sys
import h5py, numpy as np
from scipy.ndimage import distance_transform_edt

rows = list(csv.DictReader(open("out.csv")))
assert len(rows) == 7
with h5py.File(sys.argv[1]) as file:
    frames = file["particles/all/position/value"][:]
    d = 2 * file["particles/all"].attrs["seed_radius"]
step, ball = d / 8, d / 4  # the particles are closed by this ball: it fills the gaps of a dense packing
for k in (0, 6):
    centres = frames[k]
    low = centres.min(axis=0) - 1.5 * d
    covered = np.zeros(np.ceil((np.ptp(centres, axis=0) + 3 * d) / step).astype(int), bool)
    for centre in centres:
        first = np.floor((centre - low - d / 2 - ball) / step).astype(int)
        places = [low[a] + (first[a] + np.arange(14) + 0.5) * step - centre[a] for a in range(3)]
        near = sum(p**2 for p in np.meshgrid(*places, indexing="ij")) <= (d / 2 + ball) ** 2
        covered[tuple(slice(f, f + 14) for f in first)] |= near
    closed = distance_transform_edt(covered) * step > ball
    counted = closed.sum() * step**3 / float(rows[k]["box_volume [mm^3]"])
    measured = float(rows[k]["relative_density [-]"])
    print(f"frame {k}: {measured:.4f}, of the voxels {counted:.4f}")
    assert abs(measured - counted) < 0.01, (k, measured, counted)
PYTHON
}

@test "it rises steadily, the solid keeps its volume, and the porosity under the hull is what it leaves" {
    relative_density "$file/run.h5" out.csv --threads 1 --json out.json
    relative_density "$file/run.h5" two.csv --threads 2 --quiet
    cmp out.csv two.csv
    run --separate-stderr "$TOMODEM_BIN/pores" "$file/run.h5" pores.csv --json pores.json
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    [ "$(value lid pores.json)" = "convex hull" ]
    /usr/bin/python3 - <<'PYTHON'
import csv
rows, pores = ([{name.split()[0]: float(value or "nan") for name, value in row.items()} for row in csv.DictReader(open(path))]
               for path in ("out.csv", "pores.csv"))
for before, now in zip(rows, rows[1:]):
    for name in ("relative_density", "relative_density_hull"):
        assert -0.005 < now[name] - before[name] < 0.1, (name, before[name], now[name])
    assert abs(now["solid_volume"] / rows[0]["solid_volume"] - 1) < 0.03
for row, one in zip(rows, pores):  # pores too small to count are in neither
    assert abs(one["porosity"] + row["relative_density_hull"] - 1) < 0.005, (row, one)
PYTHON
}

@test "a particle that has come loose does not stretch the hull, and is counted" {
    /usr/bin/python3 - "$file/sample.h5" <<'PYTHON'
import shutil, sys, h5py
shutil.copy(sys.argv[1], "loose.h5")
with h5py.File("loose.h5", "a") as file:
    file["particles/all/position/value"][0, 0] = [5, 5, 5]
PYTHON
    relative_density "$file/sample.h5" out.csv --json whole.json
    relative_density loose.h5 out.csv --json loose.json
    close "$(value relative_density_hull loose.json)" "$(value relative_density_hull whole.json)" 0.01
    [ "$(value loose_particles loose.json)" -eq $(($(value loose_particles whole.json) + 1)) ]
}

@test "a sample of particles that lie apart is refused in one line" {
    "$synthetic_run" lattice.h5 cells=6
    fails 1 "hardly any four particles lie close together" relative_density lattice.h5 out.csv
}
