#!/usr/bin/env bats
# Samples whose particles have radii of their own, from packgen --dispersion to the run.
bats_require_minimum_version 1.5.0
load common

make_dispersed() { packgen "$1" --particles 400 --density 0.70 --dispersion 10% --quiet; }

@test "the radii go with the particles from the brick to the run" {
    make_dispersed brick.h5
    make_scene scene.toml -0.02
    relax brick.h5 scene.toml relaxed.h5 --quiet
    solve relaxed.h5 scene.toml run.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np
radius = [h5py.File(name)["particles/all/radius"][:] for name in ("brick.h5", "relaxed.h5", "run.h5")]
assert abs(radius[0].std() / radius[0].mean() - 0.1) < 1e-12
assert all(np.array_equal(radius[0], other) for other in radius)
END
}

@test "explain says that the radii differ and why" {
    make_dispersed brick.h5
    make_scene scene.toml -0.02
    run -0 solve --explain brick.h5 scene.toml run.h5
    [[ "$output" == *"dispersed_radii: on: the sample's particles have radii of their own"* ]]
}

@test "a scene that asks for radii to be drawn as well is refused" {
    make_dispersed sample.h5
    make_scene scene.toml -0.02
    sed -i '1i radius_dispersion = 0.1' scene.toml
    refuses 1 "radius_dispersion = 0.1 but the particles of the sample have radii of their own" \
        solve sample.h5 scene.toml run.h5
    refuses 1 "radii of their own" relax sample.h5 scene.toml run.h5
}

@test "NORTON refuses radii that differ" {
    make_dispersed sample.h5
    make_scene scene.toml -0.02
    sed -i 's/"bilin"/"norton"/; s/^repulsive.*/norton = { K = 100, M = 0.3 }/; /^natural_period/d; /^time_step/d' scene.toml
    refuses 1 'law "norton" is made for equal radii' solve sample.h5 scene.toml run.h5
}

@test "a file whose radii do not fit its particles is refused" {
    make_dispersed sample.h5
    make_scene scene.toml -0.02
    /usr/bin/python3 -c 'import h5py; h5py.File("sample.h5", "r+")["particles/all/radius"][6] = -1'
    refuses 1 "the radius of particle 7 (counted from 1) is -1" solve sample.h5 scene.toml run.h5
    /usr/bin/python3 - <<'END'
import h5py
with h5py.File("sample.h5", "r+") as file:
    del file["particles/all/radius"]
    file["particles/all/radius"] = [0.5] * 3
END
    refuses 1 "3 radii for 400 positions" solve sample.h5 scene.toml run.h5
}

@test "a run of dispersed spheres is the same on one and two processes" {
    make_dispersed sample.h5
    make_scene scene.toml -0.005
    solve sample.h5 scene.toml one.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/solve" sample.h5 scene.toml two.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np
one, two = (h5py.File(name)["particles/all/position/value"][1] for name in ("one.h5", "two.h5"))
assert np.abs(one - two).max() < 1e-6, np.abs(one - two).max()
END
}
