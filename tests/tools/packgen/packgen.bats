#!/usr/bin/env bats
# Packings as packgen's users get them: the file, the report, the errors.

setup() {
    cd "$BATS_TEST_TMPDIR"
    packgen=$TOMODEM_BIN/packgen
}

# read_packing FILE PYTHON: checks an HDF5 file through h5py; a are the particles, p their positions.
read_packing() {
    /usr/bin/python3 -c "import h5py, numpy as np
a = h5py.File('$1', 'r')['particles/all']
p = a['position/value'][0]
$2"
}

# refused STATUS TEXT ARGUMENTS...: fails with one line of that text, and leaves no file.
refused() {
    local status_wanted=$1 text=$2
    shift 2
    run "$packgen" "$@"
    echo "$output"
    [ "$status" -eq "$status_wanted" ]
    [ "${#lines[@]}" -eq 1 ]
    [[ "$output" == "packgen: "*"$text"* ]]
    [ -z "$(ls -A)" ]
}

@test "the file holds the particles, the box and the density that were asked for" {
    "$packgen" brick.h5 --particles 1500 --density 0.70 --seed-radius 12.5um
    read_packing brick.h5 "
edge = (1500 * np.pi / 6 / 0.70) ** (1 / 3) * 0.025
assert p.shape == (1500, 3) and p.min() >= 0 and p.max() < edge
assert (a['id'][:] == np.arange(1, 1501)).all() and (a['species'][:] == 1).all()
assert all(b in (b'periodic', 'periodic') for b in a['box'].attrs['boundary'])
assert np.allclose(a['box/edges'][:], edge, rtol=1e-12) and (a['box/origin'][:] == 0).all()"
}

@test "the report holds what the packing is like" {
    "$packgen" brick.h5 --particles 1500 --density 0.70 --json brick.json
    /usr/bin/python3 -c "
import json
r = json.load(open('brick.json'))
assert r['particles'] == 1500 and abs(r['density'] - 0.70) < 1e-12
assert 0.03 < r['max_overlap'] < 0.15 and 0.012 < r['mean_overlap'] < 0.024
assert 7.6 < r['mean_coordination'] < 8.6
assert r['steps'] > 100 and 0 < r['residual'] <= 1e-3 * r['load']"
}

@test "the particles are the same on one, two and three threads and differ with the random seed" {
    for threads in 1 2 3; do
        "$packgen" $threads.h5 --particles 600 --density 0.66 --random-seed 4 --threads $threads --quiet
    done
    "$packgen" other.h5 --particles 600 --density 0.66 --random-seed 5 --quiet
    read_packing 1.h5 "
same = lambda name: np.array_equal(p, h5py.File(name)['particles/all/position/value'][0])
assert same('2.h5') and same('3.h5') and not same('other.h5')"
}

@test "the file tells how to make it again" {
    "$packgen" brick.h5 --particles 100 --density 0.5 --random-seed 9
    read_packing brick.h5 "
command = a.file['parameters/tomodem/command_line'][()].decode()
assert '--particles 100 --density 0.5 --random-seed 9' in command, command"
}

@test "every density from a gas to 0.85 is made, and 20 particles are enough" {
    for density in 0.1 0.4 0.64 0.85; do
        "$packgen" brick.h5 --particles 400 --density $density --quiet
    done
    "$packgen" small.h5 --particles 20 --density 0.65 --quiet
}

@test "a density out of range is wrong usage" {
    refused 2 "--density 0.91 is out of range: expected at least 0.1 and at most 0.85" \
        brick.h5 --particles 1000 --density 0.91
    refused 2 "--density" brick.h5 --particles 1000 --density 0.05
    refused 2 "--density" brick.h5 --particles 1000
}

@test "too few particles fail and the message says how many are enough" {
    refused 1 "take at least 15 particles" brick.h5 --particles 10 --density 0.65
    refused 2 "--particles 0 is out of range" brick.h5 --particles 0 --density 0.65
}

@test "a radius without its unit is wrong usage" {
    refused 2 "--seed-radius" brick.h5 --particles 1000 --density 0.65 --seed-radius 0.5
}

@test "a folder that is not there fails before the packing is made" {
    refused 1 "folder 'nowhere' does not exist" nowhere/brick.h5 --particles 100000000 --density 0.65
}

@test "a failed run leaves the previous file as it was" {
    "$packgen" brick.h5 --particles 100 --density 0.5 --quiet
    before=$(sha256sum brick.h5)
    run "$packgen" brick.h5 --particles 3 --density 0.8
    [ "$status" -eq 1 ]
    [ "$(sha256sum brick.h5)" = "$before" ]
}
