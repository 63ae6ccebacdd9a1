#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# Packings as packgen's users get them: the file, the report, the errors.

setup() {
    export XDG_CACHE_HOME=$BATS_TEST_TMPDIR/cache
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work"
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
import numpy as np
r = json.load(open('brick.json'))
assert r['particles'] == 1500 and abs(r['density'] - 0.70) < 1e-12
assert 0.03 < r['max_overlap'] < 0.15 and 0.012 < r['mean_overlap'] < 0.024
assert 7.6 < r['mean_coordination'] < 8.6
assert r['steps'] > 100 and 0 < r['residual'] <= 1e-3 * r['load']
edge = (1500 * np.pi / 6 / 0.70) ** (1 / 3)
assert all(abs(r['box_edge_' + axis] / edge - 1) < 1e-12 for axis in 'xyz')"
}

@test "the particles are the same on one, two and three threads and differ with the random seed" {
    for threads in 1 2 3; do
        "$packgen" $threads.h5 --particles 600 --density 0.66 --random-seed 4 --threads $threads --no-cache --quiet
    done
    "$packgen" many.h5 --particles 600 --density 0.66 --random-seed 4 --threads $(($(nproc) + 3)) --no-cache --quiet 2> said.txt
    [ ! -s said.txt ]
    "$packgen" other.h5 --particles 600 --density 0.66 --random-seed 5 --quiet
    read_packing 1.h5 "
same = lambda name: np.array_equal(p, h5py.File(name)['particles/all/position/value'][0])
assert same('2.h5') and same('3.h5') and same('many.h5') and not same('other.h5')"
}

@test "the file holds the command that makes it again" {
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

@test "the report says how random the packing is" {
    "$packgen" brick.h5 --particles 3000 --density 0.64 --json brick.json --quiet
    /usr/bin/python3 -c "
import json
import numpy as np
r = json.load(open('brick.json'))
assert 5.7 < r['backbone_coordination'] < 6.6 and r['rattlers'] < 0.04
assert r['crystalline'] < 0.01 and r['icosahedral'] < 0.01 and r['solid_like'] < 0.02 and r['global_q6'] < 0.04
assert abs(r['crystalline'] - r['fcc'] - r['hcp'] - r['bcc']) < 1e-12
assert 0.35 < r['mean_q6'] < 0.45 and 1.25 < r['bond_cutoff'] < 1.45
t = r['radial_distribution']
radius, g = np.array(t['r']), np.array(t['g'])
assert t['r_unit'] == 'd' and np.allclose(np.diff(radius), 0.02) and abs(radius[-1] - 4.99) < 1e-6
assert abs(radius[np.argmax(g)] - 1) < 0.011 and g[radius < 0.97].max() == 0
assert abs(g[radius > 4.4].mean() - 1) < 0.03"
}

@test "spheres of many radii have the mean, the standard deviation and the volume that were asked for" {
    "$packgen" brick.h5 --particles 1000 --density 0.66 --seed-radius 2um --dispersion 20% --json brick.json --quiet
    read_packing brick.h5 "
r = a['radius'][:]
assert a['radius'].attrs['unit'] in ('mm', b'mm') and a.attrs['seed_radius'] == 0.002
assert r.shape == (1000,) and abs(r.mean() / 0.002 - 1) < 1e-12 and abs(r.std() / r.mean() - 0.2) < 1e-12
assert abs(4 / 3 * np.pi * (r ** 3).sum() / a['box/edges'][:].prod() / 0.66 - 1) < 1e-12
import json
report = json.load(open('brick.json'))
assert report['smallest_radius'] == r.min() and report['largest_radius'] == r.max()
assert abs(report['density'] - 0.66) < 1e-12"
}

@test "the box has the proportions that were asked for, in any order" {
    for aspect in 1:1:10 10:1:1 1:2.5:1; do
        "$packgen" brick.h5 --particles 800 --density 0.70 --aspect $aspect --quiet
        read_packing brick.h5 "
e = a['box/edges'][:]
wanted = np.array([float(x) for x in '$aspect'.split(':')])
assert np.allclose(e / e.min(), wanted) and abs(800 * np.pi / 6 / e.prod() / 0.70 - 1) < 1e-12
assert (p >= 0).all() and (p < e).all() and ((p.max(0) - p.min(0)) > e - 1.2).all()"
    done
}

@test "along axes that are not periodic the spheres stay inside flat walls" {
    for periodic in xy yx z none; do
        "$packgen" brick.h5 --particles 600 --density 0.55 --periodic $periodic --quiet
        read_packing brick.h5 "
e = a['box/edges'][:]
words = [b if isinstance(b, str) else b.decode() for b in a['box'].attrs['boundary']]
for axis in range(3):
    walls = 'xyz'[axis] not in '$periodic'.replace('none', '')
    assert words[axis] == ('none' if walls else 'periodic'), words
    low, high = p[:, axis].min(), e[axis] - p[:, axis].max()
    assert (low > 0.499 and high > 0.499) if walls else (low < 0.4 and high < 0.4), (axis, low, high)"
    done
}

@test "shapes and radii that cannot be are wrong usage" {
    refused 2 "--aspect '1:1': expected three positive numbers" a.h5 --particles 100 --density 0.6 --aspect 1:1
    refused 2 "--aspect '1:0:1'" a.h5 --particles 100 --density 0.6 --aspect 1:0:1
    refused 2 "--aspect '1:1:1:1'" a.h5 --particles 100 --density 0.6 --aspect 1:1:1:1
    refused 2 "--aspect '1:x:1'" a.h5 --particles 100 --density 0.6 --aspect 1:x:1
    refused 2 "--periodic 'xx'" a.h5 --particles 100 --density 0.6 --periodic xx
    refused 2 "--periodic 'w'" a.h5 --particles 100 --density 0.6 --periodic w
    refused 2 "--dispersion 25% is out of range" a.h5 --particles 100 --density 0.6 --dispersion 25%
    refused 1 "at most 100 times" a.h5 --particles 1000 --density 0.6 --aspect 1:1:101
    refused 1 "shortest edge is 1.59 seed diameters" a.h5 --particles 50 --density 0.65 --aspect 1:1:10
}

from_cache() { /usr/bin/python3 -c "import json; assert json.load(open('$1'))['from_cache'] == $2"; }

same_particles() {
    read_packing "$1" "
b = h5py.File('$2')['particles/all']
assert np.array_equal(p, b['position/value'][0]) and np.array_equal(a['box/edges'][:], b['box/edges'][:])"
}

@test "a brick that was made once is taken from the cache, with the provenance of this call" {
    "$packgen" first.h5 --particles 2000 --density 0.65 --json first.json --quiet
    "$packgen" second.h5 --density 0.650 --particles 2000 --threads 1 --json second.json --quiet
    from_cache first.json 0
    from_cache second.json 1
    same_particles first.h5 second.h5
    read_packing second.h5 "
command = a.file['parameters/tomodem/command_line'][()].decode()
assert 'second.h5 --density 0.650 --particles 2000 --threads 1' in command, command
assert a.file['parameters/tomodem/inputs/name'].shape == (0,) and 'observables' not in a.file"
    /usr/bin/python3 -c "
import json
a, b = (json.load(open(f)) for f in ('first.json', 'second.json'))
other = {'command_line', 'wall_seconds', 'cpu_seconds', 'peak_bytes', 'from_cache'}
differ = [key for key in a if key not in other and a[key] != b[key]]
assert not differ and a.keys() == b.keys(), differ"
    "$packgen" third.h5 --particles 2000 --density 0.65 --random-seed 2 --json third.json --quiet
    from_cache third.json 0
}

@test "--no-cache neither looks nor keeps" {
    "$packgen" first.h5 --particles 200 --density 0.65 --no-cache --json first.json --quiet
    [ ! -e "$XDG_CACHE_HOME" ]
    "$packgen" second.h5 --particles 200 --density 0.65 --quiet
    "$packgen" third.h5 --particles 200 --density 0.65 --no-cache --json third.json --quiet
    from_cache third.json 0
}

@test "a damaged brick in the cache is made again in silence" {
    "$packgen" first.h5 --particles 200 --density 0.65 --quiet
    kept=$(echo "$XDG_CACHE_HOME"/tomodem/packgen/*.h5)
    for damage in 'truncate -s -100' 'truncate -s 0' 'cp /dev/null' 'cp first.h5'; do
        $damage "$kept"
        run --separate-stderr "$packgen" second.h5 --particles 200 --density 0.65 --json second.json --quiet
        [ "$status" -eq 0 ]
        [ -z "$stderr" ]
        from_cache second.json 0
        same_particles first.h5 second.h5
        "$packgen" third.h5 --particles 200 --density 0.65 --json third.json --quiet
        from_cache third.json 1
    done
}

@test "a cache that cannot be written is no error" {
    XDG_CACHE_HOME=/dev/null/none "$packgen" first.h5 --particles 200 --density 0.65 --json first.json --quiet
    from_cache first.json 0
    touch "$XDG_CACHE_HOME"
    run --separate-stderr "$packgen" second.h5 --particles 200 --density 0.65 --json second.json --quiet
    [ "$status" -eq 0 ]
    [ -z "$stderr" ]
    same_particles first.h5 second.h5
}

@test "processes that make the same brick at once all get it, and one is kept" {
    for k in 1 2 3 4 5 6; do "$packgen" $k.h5 --particles 300 --density 0.65 --quiet & done
    wait
    for k in 2 3 4 5 6; do same_particles 1.h5 $k.h5; done
    [ "$(ls -A "$XDG_CACHE_HOME/tomodem/packgen" | wc -l)" -eq 1 ]
    "$packgen" last.h5 --particles 300 --density 0.65 --json last.json --quiet
    from_cache last.json 1
    same_particles 1.h5 last.h5
}
