bats_require_minimum_version 1.5.0
load common
synthetic_fields="$TOMODEM_BIN/../tests/synthetic_fields"
local_stress="$TOMODEM_BIN/local_stress"

@test "a uniform uniaxial stress is itself at every particle, with the sign of compression" {
    "$synthetic_fields" run.h5 stress=-100
    "$local_stress" run.h5 stress.h5 --table out.csv --json out.json
    close "$(value stress_equivalent_last out.json)" -1e8 1e-12
    close "$(value pressure_last out.json)" 33333333.333333 1e-9
    close "$(value radius out.json)" 1.5 1e-12
    [ "$(value frames_with_stress out.json)" -eq 2 ]
    close "$(column "stress_zz [Pa]" out.csv | tail -1)" -1e8 1e-9
    close "$(column "stress_true [Pa]" out.csv | tail -1)" -1e8 1e-9
    /usr/bin/python3 -c '
import h5py, numpy as np
with h5py.File("stress.h5") as file:
    equivalent = file["particles/all/stress_equivalent/value"]
    assert np.isnan(equivalent[0]).all() and np.allclose(equivalent[1:], -1e8, rtol=1e-12)
    assert file["particles/all/stress_average"].attrs["averaging_radius"] == 1.5
    assert file["particles/all/stress_average/value"].attrs["unit"] == b"Pa"'
}

@test "components are averaged first: a shear whose sign changes is not in the equivalent stress" {
    "$synthetic_fields" run.h5 stress=-100 shear=80 cells=8
    "$local_stress" run.h5 narrow.h5 --radius 0.1mm --json narrow.json
    "$local_stress" run.h5 wide.h5 --radius 3mm --json wide.json
    close "$(value stress_equivalent_last narrow.json)" -170880074.9 1e-6   # sqrt(100^2 + 3 * 80^2)
    close "$(value stress_equivalent_last wide.json)" -1e8 0.1
}

@test "the averages are those of numpy over all pairs, in a ball and in a Gaussian" {
    "$synthetic_fields" run.h5 stress=-100 shear=80 cells=5
    "$local_stress" run.h5 ball.h5 --radius 1.7mm --threads 3
    /usr/bin/python3 "$BATS_TEST_DIRNAME/check_fields.py" stress run.h5 ball.h5 2 ball 1.7
    "$local_stress" run.h5 gaussian.h5 --radius 1.7mm --kernel gaussian
    /usr/bin/python3 "$BATS_TEST_DIRNAME/check_fields.py" stress run.h5 gaussian.h5 1 gaussian 1.7
}

@test "the fields are the same on one thread and three, and stand where the run's particles do" {
    "$synthetic_fields" run.h5 stress=-100 shear=80 phases=2
    "$local_stress" run.h5 one.h5 --threads 1 --within-phase --table one.csv
    "$local_stress" run.h5 three.h5 --threads 3 --within-phase --table three.csv
    cmp one.csv three.csv
    /usr/bin/python3 -c '
import h5py, numpy as np
one, three, run = (h5py.File(name)["particles/all"] for name in ("one.h5", "three.h5", "run.h5"))
for name in ("stress_average", "stress_equivalent", "pressure"):
    assert np.array_equal(one[name + "/value"], three[name + "/value"], equal_nan=True)
assert np.array_equal(one["position/value"], run["position/value"])
assert np.array_equal(one["species"], run["species"])'
}

@test "chosen frames alone are written" {
    "$synthetic_fields" run.h5 frames=4
    "$local_stress" run.h5 last.h5 --frames last
    /usr/bin/python3 -c '
import h5py
with h5py.File("last.h5") as file: assert file["particles/all/pressure/value"].shape[0] == 1'
    refused 1 "never has one" "$local_stress" run.h5 first.h5 --frames first
    refused 1 "frames 0 to 3" "$local_stress" run.h5 none.h5 --frames 4
}

@test "a run without stress, a sample, and radii of zero or beyond the sample are refused" {
    "$synthetic_fields" bare.h5 field=0
    refused 1 "write \`stress = true\` under [output]" "$local_stress" bare.h5 stress.h5 --table out.csv
    "$synthetic_fields" sample.h5 field=0 frames=1 curves=0 scene=0
    refused 1 "holds no stress" "$local_stress" sample.h5 stress.h5
    "$synthetic_fields" run.h5
    refused 2 "--radius" "$local_stress" run.h5 stress.h5 --radius 0mm
    refused 1 "larger than the sample" "$local_stress" run.h5 stress.h5 --radius 50mm
    "$synthetic_fields" two.h5 particles=2
    refused 1 "larger than the sample" "$local_stress" two.h5 stress.h5
}
