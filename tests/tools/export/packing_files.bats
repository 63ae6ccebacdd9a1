#!/usr/bin/env bats
# Packing and run files as other programs see them, and as tools refuse them when they are damaged.

setup() {
    cd "$BATS_TEST_TMPDIR"
    here=$BATS_TEST_DIRNAME
    write_sample_run=$TOMODEM_BIN/../tests/write_sample_run
    export_packing=$TOMODEM_BIN/export_packing
}

# change FILE PYTHON: edits an HDF5 file through h5py, as `f`.
change() {
    /usr/bin/python3 -c "import h5py, numpy as np
f = h5py.File('$1', 'r+')
$2
f.close()"
}

refused() {
    run "$export_packing" bad.h5 out.dump
    echo "$output"
    [ "$status" -eq 1 ]
    [ "${#lines[@]}" -eq 1 ]
    [[ "$output" == "export_packing: cannot read 'bad.h5'"*"$1"* ]]
    [ ! -e out.dump ]
}

@test "a run opens in h5py as H5MD 1.1 with the numbers that were written" {
    "$write_sample_run" 7 3 run.h5
    /usr/bin/python3 "$here/check_h5md.py" 7 3 run.h5
}

@test "the XDMF of a sample, of a run and of fields names the numbers that h5py reads" {
    "$write_sample_run" 9 1 sample.h5
    "$write_sample_run" 7 3 run.h5 fields.h5
    /usr/bin/python3 "$here/read_xdmf.py" plain fields.xdmf fields.h5
    /usr/bin/python3 "$here/read_xdmf.py" plain sample.xdmf sample.h5
    /usr/bin/python3 "$here/read_xdmf.py" plain run.xdmf run.h5
}

@test "VTK's XDMF readers give the numbers that h5py reads" {
    "$write_sample_run" 9 1 sample.h5
    "$write_sample_run" 7 3 run.h5 fields.h5
    for reader in xdmf2 xdmf3; do
        run /usr/bin/python3 "$here/read_xdmf.py" $reader sample.xdmf sample.h5
        [ "$status" -ne 3 ] || skip "the VTK of this machine is built without XDMF (Debian's python3-paraview has it)"
        [ "$status" -eq 0 ]
        /usr/bin/python3 "$here/read_xdmf.py" $reader run.xdmf run.h5
        /usr/bin/python3 "$here/read_xdmf.py" $reader fields.xdmf fields.h5
    done
}

@test "a file and its XDMF can be moved together" {
    mkdir "a b & c"
    "$write_sample_run" 7 3 "a b & c/run one.h5"
    mv "a b & c" moved
    /usr/bin/python3 "$here/read_xdmf.py" plain "moved/run one.xdmf" "moved/run one.h5"
}

@test "the example of docs/file-formats.md runs" {
    "$write_sample_run" 7 3 run.h5
    sed -n '/^```python$/,/^```$/{/^```/!p}' "$TOMODEM_SOURCE/docs/file-formats.md" > example.py
    echo 'assert inclusions.shape == (3, 3) and len(strain) == len(stress) == 3' >> example.py
    /usr/bin/python3 example.py
}

@test "a writer that is interrupted leaves nothing behind" {
    "$write_sample_run" 200000 100 run.h5 &
    writer=$!
    for _ in $(seq 2000); do
        compgen -G '.run.part-*.h5' > found && break
        sleep 0.01
    done
    [ -s found ]
    kill -TERM $writer
    wait $writer || true
    [ "$(ls -A)" = found ]
}

@test "a file cut in half is refused in one line" {
    "$write_sample_run" 1000 3 run.h5
    head -c $(($(stat -c %s run.h5) / 2)) run.h5 > bad.h5
    refused "the file is cut short"
}

@test "a file that is not HDF5 is refused" {
    echo "hello" > bad.h5
    refused "not an HDF5 file"
}

@test "another program's HDF5 file is refused" {
    /usr/bin/python3 -c "import h5py; h5py.File('bad.h5', 'w')['x'] = 1"
    refused "not a packing or run of tomodem"
}

@test "species of another length are refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all/species']; f['particles/all/species'] = np.ones(6, int)"
    refused "species has 6 values but /particles/all/position/value has 7 rows"
}

@test "ids of another length are refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all/id']; f['particles/all/id'] = np.arange(6)"
    refused "6 ids for 7 positions"
}

@test "ids that occur twice are refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "f['particles/all/id'][3] = f['particles/all/id'][2]"
    refused "ids are not unique and increasing: 16 follows 16"
}

@test "a position that is not a number is refused, in whichever frame it is" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "f['particles/all/position/value'][2, 4, 1] = np.nan"
    refused "frame 2: the position of particle 5 (counted from 1) is not a finite number"
}

@test "a missing dataset is refused by its name" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all/id']"
    refused "it has no /particles/all/id"
}

@test "a missing seed radius is refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all'].attrs['seed_radius']"
    refused "no attribute seed_radius"
}

@test "text where numbers belong is refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all/species']; f['particles/all/species'] = ['iron'] * 7"
    refused "/particles/all/species does not hold numbers"
}

@test "steps that do not match the frames are refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['particles/all/position/step']; f['particles/all/position/step'] = [1, 2]"
    refused "has 3 frames, but there are 2 steps and 3 times"
}

@test "a curve whose arrays differ in length is refused" {
    "$write_sample_run" 7 3 bad.h5
    change bad.h5 "del f['observables/strain/time']; f['observables/strain/time'] = [0.0]"
    refused "/observables/strain has 3 values, 3 steps and 1 times"
}

@test "an id array from h5py in another integer type is read all the same" {
    "$write_sample_run" 7 3 run.h5
    change run.h5 "del f['particles/all/id']; f['particles/all/id'] = np.arange(1, 8, dtype=np.uint16)"
    "$export_packing" --frames first run.h5 run.dump
    [ "$(sed -n 10p run.dump | cut -d' ' -f1)" = 1 ]
}

@test "a full disk gives one line and leaves nothing behind" {
    mkdir disk
    mount -t tmpfs -o size=1m tmpfs disk 2> mount.txt || skip "no permission to mount a small tmpfs"
    run "$write_sample_run" 20000 30 disk/run.h5
    echo "$output"
    left=$(ls -A disk)
    umount disk
    [ "$status" -eq 1 ]
    [ "$output" = "cannot write 'disk/run.h5': no space left on the disk" ]
    [ -z "$left" ]
}

@test "a disk that fills up while the last bytes are written gives one line and leaves nothing behind" {
    mkdir disk
    "$write_sample_run" 4000 3 whole.h5
    kib=$(($(stat -c %s whole.h5) / 1024))
    for spare in 0 4 8 12 16 20; do
        mount -t tmpfs -o size=$((kib / 4 * 4 - spare))k tmpfs disk 2> mount.txt || skip "no permission to mount a small tmpfs"
        run "$write_sample_run" 4000 3 disk/run.h5
        left=$(ls -A disk)
        umount disk
        echo "$spare: $status $output"
        [ "$status" -eq 1 ]
        [ "$output" = "cannot write 'disk/run.h5': no space left on the disk" ]
        [ -z "$left" ]
    done
}
