bats_require_minimum_version 1.5.0
load common
synthetic_fields="$TOMODEM_BIN/../tests/synthetic_fields"
local_strain="$TOMODEM_BIN/local_strain"

@test "a uniform compression is the strain of every particle, and nothing of it is non-affine" {
    "$synthetic_fields" run.h5 field=0 strain=0.3 frames=4
    "$local_strain" run.h5 strain.h5 --table out.csv --json out.json
    close "$(value strain_equivalent_last out.json)" 0.3 1e-9
    [ "$(value without_strain_last out.json)" -eq 0 ]
    close "$(column "strain_zz [-]" out.csv | tail -1)" -0.3 1e-9
    close "$(column "strain_xx [-]" out.csv | sed -n 3p)" 0.1 1e-9
    /usr/bin/python3 -c '
import h5py, numpy as np
with h5py.File("strain.h5") as file:
    particles = file["particles/all"]
    assert np.allclose(particles["strain/value"][3], [0.15, 0.15, -0.3, 0, 0, 0], atol=1e-12)
    assert np.allclose(particles["strain_linear/value"][3, :, 2], np.exp(-0.3) - 1, atol=1e-12)
    assert np.allclose(particles["strain_volumetric/value"], 0, atol=1e-12)
    assert np.abs(particles["non_affine/value"]).max() < 1e-12'
}

@test "a turn of the sample is no strain" {
    "$synthetic_fields" run.h5 field=0 strain=0.3 turn=0.7
    "$local_strain" run.h5 strain.h5 --table out.csv --json out.json
    close "$(value strain_equivalent_last out.json)" 0.3 1e-9
    close "$(column "strain_zz [-]" out.csv | tail -1)" -0.3 1e-9
    close "$(column "strain_xx [-]" out.csv | tail -1)" 0.15 1e-9
}

@test "strains from the frame before are the increments" {
    "$synthetic_fields" run.h5 field=0 strain=0.3 frames=4
    "$local_strain" run.h5 strain.h5 --reference previous --table out.csv
    [ "$(column "reference [-]" out.csv | tr '\n' ' ')" = "0 0 1 2 " ]
    close "$(column "strain_zz [-]" out.csv | tail -1)" -0.1 1e-9
    "$local_strain" run.h5 back.h5 --reference 3 --frames first --table back.csv
    close "$(column "strain_zz [-]" back.csv)" 0.3 1e-9
}

@test "what neighbours did that is not affine is that of numpy, in a sample that flows" {
    "$TOMODEM_BIN/packgen" brick.h5 --particles 500 --density 0.64 --quiet
    cp brick.h5 run.h5
    # Two frames of a free block, the second shaken.
    /usr/bin/python3 - <<'PYTHON'
import h5py, numpy as np
with h5py.File("run.h5", "a") as file:
    particles = file["particles/all"]
    place = particles["position/value"][0]
    d = 2 * particles.attrs["seed_radius"]
    assert d == 1
    second = place * [1.1, 1.05, 0.8] + np.random.default_rng(1).normal(0, 0.1, place.shape)
    del particles["position"]
    group = particles.create_group("position")
    group["value"] = np.stack([place, second])
    group["step"], group["time"] = [0, 1], [0.0, 1.0]
    particles["box"].attrs["boundary"] = np.array([b"none"] * 3)
PYTHON
    "$local_strain" run.h5 strain.h5 --radius 1.6mm --threads 3
    /usr/bin/python3 "$BATS_TEST_DIRNAME/check_fields.py" strain run.h5 strain.h5 1 0 1.6
    "$local_strain" run.h5 one.h5 --radius 1.6mm --threads 1
    /usr/bin/python3 -c '
import h5py, numpy as np
one, three = (h5py.File(name)["particles/all"] for name in ("one.h5", "strain.h5"))
for name in ("strain", "strain_linear", "non_affine"):
    assert np.array_equal(one[name + "/value"], three[name + "/value"], equal_nan=True)'
}

@test "a sample, missing frames, and radii without neighbours or beyond the sample are refused" {
    "$synthetic_fields" sample.h5 field=0 frames=1
    refused 1 "a run of two or more" "$local_strain" sample.h5 strain.h5
    "$synthetic_fields" run.h5 field=0
    refused 1 "frames 0 to 2" "$local_strain" run.h5 strain.h5 --frames 3
    refused 1 "--reference 3: the file has frames 0 to 2" "$local_strain" run.h5 strain.h5 --reference 3
    refused 2 "--reference 'next'" "$local_strain" run.h5 strain.h5 --reference next
    refused 1 "take a larger one" "$local_strain" run.h5 strain.h5 --radius 0.5mm --table out.csv
    refused 1 "larger than the sample" "$local_strain" run.h5 strain.h5 --radius 50mm
    refused 2 "--radius" "$local_strain" run.h5 strain.h5 --radius 0mm
    "$synthetic_fields" two.h5 field=0 particles=2
    refused 1 "take a larger one" "$local_strain" two.h5 strain.h5 --radius 0.6mm
}
