# Every tool that reads particles, on samples with little or nothing in them: a result, or one clear line and no file.
bats_require_minimum_version 1.5.0
load common

# sample FILE POSITIONS [OBJECTS]: a sample of unit spheres at the rows of a numpy expression.
sample() {
    /usr/bin/python3 - "$@" <<'PYTHON'
import sys
import h5py
import numpy as np
at = np.asarray(eval(sys.argv[2]), float).reshape(-1, 3)
with h5py.File(sys.argv[1], "w") as file:
    file.create_group("h5md").attrs["version"] = [1, 1]
    particles = file.create_group("particles/all")
    particles.attrs["seed_radius"] = 0.5
    particles["species"] = np.ones(len(at), np.int32)
    particles["id"] = np.arange(1, len(at) + 1)
    if len(sys.argv) > 3:
        particles["object"] = np.full(len(at), int(sys.argv[3]), np.int32)
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = ["none"] * 3
    box["edges"] = np.ptp(at, axis=0) + 1
    box["origin"] = at.min(axis=0) - 0.5
    position = particles.create_group("position")
    position["value"], position["step"], position["time"] = at[None], np.array([0]), np.array([0.0])
PYTHON
}

# on_all FILE: every tool; what fails is collected.
on_all() {
    [ -e image.h5 ] || /usr/bin/python3 -c "import h5py, numpy; h5py.File('image.h5', 'w')['labels'] = numpy.ones((8, 8, 8), 'u1')"
    local wrong=0 tool out
    while read -r tool out; do
        local -a command=("$tool" "$1" "$out")
        [ "$tool" != norton_fit ] || command=("$tool" "$1" "$1" "$out")
        [ "$tool" != compare_shapes ] || command=("$tool" "$1" image.h5:/labels "$out" --voxel-size 1mm --objects 1)
        rm -rf out.*
        run --separate-stderr "$TOMODEM_BIN/${command[0]}" "${command[@]:1}"
        if [ "$status" -eq 0 ]; then
            [ -e "$out" ] || { echo "$tool: done, but no $out"; wrong=1; }
        elif [ "$status" -gt 2 ] || [ "$(wc -l <<<"$stderr")" -ne 1 ] || [[ "$stderr" != "$tool: "* ]] || compgen -G 'out.*' > /dev/null; then
            echo "$tool: status $status, files $(compgen -G 'out.*' | tr '\n' ' '), $stderr"
            wrong=1
        fi
        echo "# $tool: $status ${stderr%%$'\n'*}"
    done <<<'mesh_recon out.stl
topology out.csv
pores out.csv
volume_change out.csv
stress_strain out.csv
equilibrium out.csv
norton_fit out.csv
shape_factor out.csv
object_shapes out.csv
compare_shapes out.csv
control_numbers out.csv
coordination out.csv
crystallinity out.csv
local_stress out.h5
local_strain out.h5
export_packing out.vtp
render out.png
report out.html'
    return $wrong
}

@test "two particles" { sample bad.h5 "[[0, 0, 0], [1, 0, 0]]" && on_all bad.h5; }

@test "one particle" { sample bad.h5 "[[0, 0, 0]]" && on_all bad.h5; }

@test "all particles in one plane" { sample bad.h5 "[(i, j, 0) for i in range(12) for j in range(12)]" && on_all bad.h5; }

@test "all particles on one line" { sample bad.h5 "[(i, 0, 0) for i in range(40)]" && on_all bad.h5; }

@test "all particles at one place" { sample bad.h5 "np.zeros((30, 3))" && on_all bad.h5; }

@test "particles that are far from each other" { sample bad.h5 "[(9 * i, 9 * j, 9 * k) for i in range(4) for j in range(4) for k in range(4)]" && on_all bad.h5; }

@test "objects of a few particles in one plane" { sample bad.h5 "[(i, j, 0) for i in range(6) for j in range(6)]" 1 && on_all bad.h5; }
