bats_require_minimum_version 1.5.0
load common

# A small run of the solver, once for all tests of this file.
setup_file() {
    cd "$BATS_FILE_TMPDIR"
    cat >scene.toml <<'SCENE'
seed_radius = 0.5
[phase.matrix]
label = 1
law = "bilin"
norton = { K = 5020, M = 0.49 }
[load]
axis = "z"
steps = [ { strain = -0.2, rate = 1e-3 } ]
[accuracy]
strain_per_step = 4e-5
frames = 4
[output]
stress = true
SCENE
    "$TOMODEM_BIN/packgen" brick.h5 --particles 1000 --density 0.70 --quiet
    "$TOMODEM_BIN/relax" brick.h5 scene.toml relaxed.h5 --quiet
    "$TOMODEM_BIN/solve" relaxed.h5 scene.toml run.h5 --quiet
}

@test "the mean stress of the particles carries the force of the planes over their distance" {
    "$TOMODEM_BIN/local_stress" "$BATS_FILE_TMPDIR/run.h5" stress.h5 --table stress.csv
    /usr/bin/python3 - "$BATS_FILE_TMPDIR/run.h5" <<'PYTHON'
import csv, sys
import h5py, numpy as np
rows = list(csv.DictReader(open("stress.csv")))
with h5py.File(sys.argv[1]) as file:
    particles = file["particles/all"]
    first = particles["position/value"][0][:, 2]
    edge, d = particles["box/edges"][2], 2 * particles.attrs["seed_radius"]
assert len(rows) == 4
for row in rows[1:]:
    strain, mean, true = (float(row[name]) for name in
                          ("strain [-]", "stress_axial_of_particles [Pa]", "stress_true [Pa]"))
    # The planes are a diameter further apart than the outermost centres; the true stress is over V0 / (edge e^strain).
    levers = (np.ptp(first) * np.exp(strain) + d) / (edge * np.exp(strain))
    assert abs(mean / (true * levers) - 1) < 0.03, (strain, mean, true * levers)
PYTHON
}

@test "the mean of the local strains is the best uniform deformation of the sample" {
    "$TOMODEM_BIN/local_strain" "$BATS_FILE_TMPDIR/run.h5" strain.h5 --json strain.json
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
with h5py.File("strain.h5") as file:
    particles = file["particles/all"]
    before, now = (p - p.mean(axis=0) for p in particles["position/value"][[0, -1]])
    mean = np.nanmean(particles["strain/value"][-1], axis=0)[:3]
gradient = np.linalg.lstsq(before, now, rcond=None)[0].T
whole = np.log(np.diag(gradient))
assert np.abs(mean - whole).max() < 0.02, (mean, whole)
assert -0.2 < mean[2] < -0.05  # the rest is in the faces that the planes flatten
PYTHON
}

@test "a calibrated run is in the quasi-static range" {
    run --separate-stderr "$TOMODEM_BIN/control_numbers" "$BATS_FILE_TMPDIR/run.h5" control.csv --json control.json
    [ "$status" -eq 0 ]
    /usr/bin/python3 -c '
import json
out = json.load(open("control.json"))
assert 0.68 < out["density_first"] < 0.73 and 0.68 < out["density_last"] < 0.74, out
assert 10 < out["stiffness_level_last"] < 30 and 1e-3 < out["inertial_number_last"] < 1e-2, out
assert out["kinetic_over_elastic_last"] < 0.02, out'
}
