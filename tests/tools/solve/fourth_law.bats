#!/usr/bin/env bats
# A law that tomodem does not have, DASHPOT, stands in tests/unit/solver/dashpot_law.cpp alone.

load common

solve_with_dashpot() { "$TOMODEM_BIN/../tests/solve_with_dashpot" "$@"; }

# 25 columns of two particles, 1.2 mm apart along every edge: in the crown of 1.5 mm there are no diagonals.
make_columns() {
    make_sample columns.h5 500
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

with h5py.File("columns.h5", "r+") as file:
    group = file["particles/all"]
    points = 1.2 * np.stack(np.meshgrid(range(5), range(5), range(2), indexing="ij"), -1).reshape(-1, 3)
    for name, values in (("position/value", points[None]), ("species", np.ones(50)), ("id", np.arange(1, 51))):
        kind, unit = group[name].dtype, dict(group[name].attrs)
        del group[name]
        group[name] = values.astype(kind)
        group[name].attrs.update(unit)
    group["box/edges"][:] = [6, 6, 2.4]
    group.attrs["relaxed"] = np.int32(1)
    group.attrs["seed_radius"] = 0.5
    group["box"].attrs["boundary"] = np.array([b"none"] * 3, dtype=group["box"].attrs["boundary"].dtype)
END
}

make_dashpot_scene() {
    cat > scene.toml <<'END'
[phase.a]
label = 1
law = "dashpot"
repulsive_stiffness = 1e8
natural_period = 0.02
viscosity = 1e5

[load]
steps = [ { strain = -0.1, rate = 1e-2 } ]

[accuracy]
averaging_strain = 1e-3
frames = 2
END
}

@test "a scene of a fourth law runs, and the planes feel the dashpots' force" {
    make_columns
    make_dashpot_scene
    solve_with_dashpot columns.h5 scene.toml run.h5 --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/../tests/solve_with_dashpot" columns.h5 scene.toml two.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

for name in "run.h5", "two.h5":
    with h5py.File(name) as run:
        strain, force = (run[f"observables/{key}/value"][:] for key in ("strain", "force_top"))
    # The distance of the two layers is 1.2 mm exp(strain): each of the 25 columns has F = c rate distance.
    expected = -25 * 1e5 * 1e-2 * 1.2 * np.exp(strain)
    later = strain < -0.01
    assert later.sum() > 100
    assert np.max(np.abs(force[later] / expected[later] - 1)) < 2e-3, force[later] / expected[later]
END
}

@test "it is explained, and its keys are checked, as those of the other laws" {
    make_columns
    make_dashpot_scene
    solve_with_dashpot columns.h5 scene.toml run.h5 --explain >out.txt
    grep -q 'dashpots.*on: law "dashpot"' out.txt
    sed -i 's/^viscosity.*//' scene.toml
    refuses 1 "has no 'viscosity'" solve_with_dashpot columns.h5 scene.toml run.h5
    make_dashpot_scene
    refuses 1 'law must be "bilin", "trilin" or "norton"' solve columns.h5 scene.toml run.h5
}
