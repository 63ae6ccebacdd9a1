#!/usr/bin/env bats
# The same laws from a plain LIGGGHTS input script (docs/plain-liggghts.md).

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    PATH="$TOMODEM_BIN:$PATH"
    here="$TOMODEM_SOURCE/docs/examples"
}

# press EXAMPLE LIGGGHTS...
press() {
    local example=$1
    shift
    LD_PRELOAD="$TOMODEM_LIB/libtomodem_liggghts.so" "$@" -var here "$here" -in "$here/$example.in" >log.txt 2>&1
}

@test "the example runs in the stock liggghts and balances the two plates" {
    press two_plates liggghts
    /usr/bin/python3 - <<'END'
import numpy as np

step, top, bottom = np.loadtxt("two_plates.txt").T
assert step[-1] == 20000
assert np.all(np.abs(top) > 1e6)
assert np.max(np.abs(top + bottom)) < 1e-3 * np.max(np.abs(top))
END
}

@test "it gives the same on two processes" {
    press two_plates liggghts
    mv two_plates.txt one.txt
    press two_plates mpirun --oversubscribe -np 2 liggghts
    cat one.txt two_plates.txt
    /usr/bin/python3 -c '
import numpy as np
one, two = np.loadtxt("one.txt"), np.loadtxt("two_plates.txt")
assert np.allclose(one[:8], two[:8], rtol=1e-4)'
}

@test "norton of a script resists the plates as that of solve does" {
    press norton_plates liggghts
    # The particles of the script as a sample, between the same plates that move in the same way.
    packgen sample.h5 --particles 500 --density 0.65 --quiet
    /usr/bin/python3 - <<'END'
import os
import re

import h5py
import numpy as np

lines = open("norton_plates.txt.start").read().split("\n")
rows = np.array([line.split() for line in lines[9:] if line], float)
points = rows[np.argsort(rows[:, 0]), 1:]
count = len(points)
assert count == 343
with h5py.File("sample.h5", "r+") as file:
    group = file["particles/all"]
    for name, values in (("position/value", points[None]), ("species", np.ones(count)), ("id", np.arange(1, count + 1))):
        kind, unit = group[name].dtype, dict(group[name].attrs)
        del group[name]
        group[name] = values.astype(kind)
        group[name].attrs.update(unit)
    group["box/edges"][:] = np.ptp(points, axis=0)
    group["box/origin"][:] = points.min(axis=0)
    group["box"].attrs["boundary"] = np.array([b"none"] * 3, dtype=group["box"].attrs["boundary"].dtype)
    group.attrs["relaxed"] = np.int32(1)
plate = open(os.environ["TOMODEM_SOURCE"] + "/docs/examples/plate.stl").read()
for name, height in ("top", 3.42), ("bottom", -3.42):
    open(f"{name}.stl", "w").write(re.sub(r"(vertex \S+ \S+) 0", rf"\1 {height}", plate))
END
    cat > scene.toml <<'END'
[phase.a]
label = 1
law = "norton"
norton = { K = 100, M = 0.3 }

[[wall]]
name = "top"
surface = "top.stl"
velocity = [0, 0, -3e-3]

[[wall]]
name = "bottom"
surface = "bottom.stl"
velocity = [0, 0, 3e-3]

[load]
duration = "120 s"
rate = 1e-3

[accuracy]
scheme = "explicit"
END
    solve sample.h5 scene.toml run.h5 --quiet
    /usr/bin/python3 - <<'END'
import h5py
import numpy as np

step, top, bottom = np.loadtxt("norton_plates.txt").T
with h5py.File("run.h5") as run:
    curve = run["observables/wall_top_force_z"]
    force, time = curve["value"][:], curve["time"][:]
seconds = 0.06 * (step - 50)  # of the middle of each mean
later = seconds > 40
ratio = top[later] / np.interp(seconds[later], time, np.abs(force))
print(ratio)
assert np.all(np.abs(ratio - 1) < 0.02)
assert np.max(np.abs(top + bottom)[later]) < 0.01 * np.max(top)
END
}

@test "norton of a script gives the same on two processes" {
    press norton_plates liggghts
    mv norton_plates.txt one.txt
    press norton_plates mpirun --oversubscribe -np 2 liggghts
    /usr/bin/python3 -c '
import numpy as np
one, two = np.loadtxt("one.txt"), np.loadtxt("norton_plates.txt")
assert np.allclose(one, two, rtol=1e-3)'
}

@test "norton of a script does not run without the self-contact that is asked for" {
    sed '/^pair_coeff/a fix contact all tomodem/contact seed_radius 0.5' "$here/norton_plates.in" > asked.in
    cp "$here/plate.stl" .
    here=$PWD
    run press asked liggghts
    [ "$status" -ne 0 ]
    grep -q 'model norton cannot tell surfaces that meet from the pairs inside: remove fix contact, or take model trilin' log.txt
}

@test "surfaces of a script that meet under self-contact part without a pull" {
    press two_blocks liggghts
    mv two_blocks.txt free.txt
    press two_blocks liggghts -var self_contact 0
    /usr/bin/python3 - <<'END'
import numpy as np

free, welded = np.loadtxt("free.txt"), np.loadtxt("two_blocks.txt")
pressed = free[4, 1]
assert pressed > 3e8
# What is left is the drag of one block: 100 particles, 5e7 uN s/mm, 5e-3 mm/s.
assert abs(free[-1, 1] / -2.5e7 - 1) < 0.01, free
assert welded[-1, 1] < -2e8, welded
END
}

@test "without the plugin the stock liggghts does not know the law" {
    run liggghts -var here "$here" -in "$here/two_plates.in"
    [ "$status" -ne 0 ]
    [[ "$output" == *"Invalid model"* ]]
}
