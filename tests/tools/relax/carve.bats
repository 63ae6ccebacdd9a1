# carve: pores of the right volume, resuming after a kill, and what it refuses.

bats_require_minimum_version 1.5.0
load common

setup_file() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_FILE_TMPDIR" || exit 1
    load common
    make_scene scene.toml
    make_pore pore.tif 72 36
    packgen brick.h5 --particles 3000 --density 0.66 --quiet
    vol2pack brick.h5 pore.tif dense.h5 --voxel-size 10um --pixels-per-seed 2 --relabel 0=1 --quiet
}

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
    cp "$BATS_FILE_TMPDIR"/{scene.toml,pore.tif,dense.h5,brick.h5} .
}

# carved OUTPUT [OPTION...]: with a pore of 9 particles across, judged
carved() {
    local file=$1
    shift
    carve dense.h5 scene.toml pore.tif "$file" --voxel-size 10um --judged-from 8 --quiet "$@"
}

# killed_after ITERATION OUTPUT: kill -9 once that row is in the table
killed_after() {
    carve dense.h5 scene.toml pore.tif "$2" --voxel-size 10um --judged-from 8 --quiet & process=$!
    for _ in $(seq 3000); do
        if [ -e "$2.state" ] && grep -q "^$1," "${2%.h5}.csv"; then break; fi
        sleep 0.01
    done
    kill -9 $process
    wait $process || true
    [ -e "$2.state" ] && [ ! -e "$2" ]
}

@test "a pore is as large as the image's, by both measures and by the mass that is missing; one pass leaves it smaller" {
    carved out.h5 --json out.json --pores pores.csv
    vol2pack brick.h5 pore.tif masked.h5 --voxel-size 10um --pixels-per-seed 2 --quiet
    relax masked.h5 scene.toml once.h5 --quiet
    relax dense.h5 scene.toml full.h5 --quiet
    [ ! -e out.h5.state ]
    /usr/bin/python3 - <<'END'
import csv
import json
import h5py
import numpy as np

summary = json.load(open("out.json"))
assert abs(summary["total_error"]) <= 0.02 and abs(summary["worst_pore_error"]) <= 0.05, summary
assert abs(summary["total_error_by_grid"]) < 0.05 and summary["intersection_over_union"] > 0.85, summary
rows = list(csv.DictReader(open("out.csv")))
assert [int(row["iteration"]) for row in rows] == list(range(len(rows))) and len(rows) == summary["iterations"] + 1
volumes = [float(row["volume [mm^3]"]) for row in rows]
assert volumes[0] == 0 and all(a < b for a, b in zip(volumes, volumes[1:])), volumes
assert sum(int(row["removed"]) for row in rows) == int(rows[0]["particles"]) - summary["particles"]
pores = list(csv.DictReader(open("pores.csv")))
assert len(pores) == 1 and abs(float(pores[0]["across [particles]"]) - 9) < 0.1

# Material that is missing from a ball around the pore, at the density that the full sample has there.
centre = np.array([float(pores[0][f"{axis} [mm]"]) for axis in "xyz"])
target = float(pores[0]["target [mm^3]"])
def counts(name):
    position = h5py.File(name)["particles/all/position/value"][0]
    distance = np.sort(np.linalg.norm(position - centre, axis=1))
    return np.searchsorted(distance, radii)
radii = np.linspace(6, 7.5, 31) * 0.04
ball = 4 / 3 * np.pi * radii**3
density = (counts("full.h5") / ball).mean()
missing = {name: (ball - counts(name) / density).mean() / target for name in ("out.h5", "once.h5")}
print(missing)
assert abs(missing["out.h5"] - 1) < 0.06, missing
assert missing["once.h5"] < missing["out.h5"] - 0.01, missing
END
}

@test "two processes end within the same errors" {
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/carve" dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --judged-from 8 \
        --json out.json --quiet
    /usr/bin/python3 -c '
import json
s = json.load(open("out.json"))
assert abs(s["total_error"]) <= 0.02 and abs(s["worst_pore_error"]) <= 0.05 and s["intersection_over_union"] > 0.85, s'
}

@test "killed after any iteration it goes on to the same particles" {
    carved whole.h5
    for iteration in 0 1; do
        rm -f out.*
        killed_after $iteration out.h5
        carved out.h5 --resume
        cmp out.csv whole.csv
        /usr/bin/python3 -c '
import h5py
one, two = (h5py.File(name)["particles/all"] for name in ("whole.h5", "out.h5"))
assert (one["id"][()] == two["id"][()]).all()
assert (one["position/value"][()] == two["position/value"][()]).all()'
    done
}

@test "the state of another scene or of other options is refused" {
    killed_after 0 out.h5
    sed 's/-0.1/-0.2/' scene.toml > other.toml
    refused 1 "another scene" carve dense.h5 other.toml pore.tif out.h5 --voxel-size 10um --judged-from 8 --quiet --resume
    refused 1 "cannot resume from 'out.h5.state'" carved out.h5 --resume --first-share 0.5
    refused 1 "other options of the volume" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --roi 0:71,0:72,0:72 --judged-from 8 \
        --quiet --resume
    carved out.h5 --resume --pore-error 3%
}

@test "a sample that is masked already is worked on, with a warning" {
    vol2pack brick.h5 pore.tif masked.h5 --voxel-size 10um --pixels-per-seed 2 --quiet
    refused 0 "the sample is masked already" \
        carve masked.h5 scene.toml pore.tif out.h5 --voxel-size 10um --judged-from 8 --quiet
    [ -e out.h5 ]
}

@test "an image without a pore, of another scale, of another place, or too coarse is refused" {
    refused 1 "the volume has no pore" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --relabel 0=1 --quiet
    refused 1 "says that its voxels are 10 x 10 x 10 um" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 24um --quiet
    refused 1 "the volume and the sample do not lie over each other" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --roi 0:72,0:72,0:40 --quiet
    refused 1 "are too small for these particles" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --min-pore 20 --quiet
    refused 1 "there is no pore to carve" \
        carve dense.h5 scene.toml pore.tif out.h5 --voxel-size 10um --relabel 1=0,0=1 --quiet
    [ ! -e out.h5 ] && [ ! -e out.csv ] && [ ! -e out.h5.state ]
}

@test "a folder that cannot be written to is found before any work" {
    [ "$(id -u)" -ne 0 ] || skip "root writes anywhere"
    mkdir closed
    chmod a-w closed
    refused 1 "closed" carved closed/out.h5
}

@test "too few iterations are an error that says how far it is, and more of them go on" {
    refused 1 "the pores are not as large as the image's after 1 iterations: total volume -" carved out.h5 --max-iterations 1
    [ ! -e out.h5 ] && [ -e out.csv ]
    carved out.h5 --resume
    [ -e out.h5 ]
}

@test "a sample whose pores are too large is refused with what takes it as it is, and that does" {
    make_pore larger.tif 72 40
    vol2pack brick.h5 larger.tif masked.h5 --voxel-size 10um --pixels-per-seed 2 --quiet
    local command=(carve masked.h5 scene.toml pore.tif out.h5 --voxel-size 10um --judged-from 8 --quiet)
    run -1 "${command[@]}"
    [ ! -e out.h5 ] && [ -e out.h5.state ]
    advice=$(sed -n 's/.*the same command with \(.*\) takes the sample as it is$/\1/p' <<<"$output")
    [[ $output == *"the sample had pores already: start from a dense one"* ]]
    # shellcheck disable=SC2086
    "${command[@]}" $advice --json out.json
    run -1 "${command[@]}" --total-error 9% --pore-error 9%  # less than it has
    /usr/bin/python3 -c '
import json
s = json.load(open("out.json"))
assert 0.1 < s["total_error"] < 0.6, s'
}

@test "a pore that a face cuts is carved to its volume within the sample" {
    /usr/bin/python3 -c '
import numpy as np
z, y, x = np.mgrid[:72, :72, :72] + 0.5
def ball(a, b, c, r):
    return (x - a)**2 + (y - b)**2 + (z - c)**2 < r*r
open("cut.raw", "wb").write((~(ball(0, 36, 36, 20) | ball(50, 58, 40, 12))).astype(np.uint8).tobytes())'
    options=(--raw-size 72 --raw-type uint8 --voxel-size 10um)
    vol2pack brick.h5 cut.raw full.h5 "${options[@]}" --pixels-per-seed 2 --relabel 0=1 --quiet
    carve full.h5 scene.toml cut.raw out.h5 "${options[@]}" --judged-from 7 --json out.json --pores pores.csv --quiet
    /usr/bin/python3 - <<'END'
import csv
import json
import h5py
import numpy as np

summary = json.load(open("out.json"))
assert summary["cut_pores"] == 2 and summary["closed_pores"] == 0 and summary["judged_pores"] == 1, summary
assert abs(summary["total_error"]) <= 0.02 and abs(summary["total_error_by_grid"]) < 0.06, summary
pores = {float(row["x [mm]"]) < 0.2: row for row in csv.DictReader(open("pores.csv"))}
half = 2 / 3 * np.pi * 0.2**3
assert 0.85 < float(pores[True]["target [mm^3]"]) / half < 1.0, pores  # the face has drawn in
assert all(row["cut"] == "1" for row in pores.values())
# Half a ball without particles at the face, by their own radius nearer than the pore's surface.
position = h5py.File("out.h5")["particles/all/position/value"][0]
distance = np.linalg.norm(position - [0, 0.36, 0.36], axis=1)
assert 0.19 < distance.min() < 0.24, distance.min()
END
}
