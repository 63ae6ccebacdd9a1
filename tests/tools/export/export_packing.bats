#!/usr/bin/env bats

setup() {
    cd "$BATS_TEST_TMPDIR"
    here=$BATS_TEST_DIRNAME
    export_packing=$TOMODEM_BIN/export_packing
    "$TOMODEM_BIN/../tests/write_sample_run" 7 3 run.h5
}

@test "the dump holds every frame with the numbers of the file" {
    "$export_packing" run.h5 run.dump
    /usr/bin/python3 "$here/check_export.py" dump run.h5 0,1,2 run.dump
}

@test "the VTP of one frame opens in VTK with the numbers of the file" {
    "$export_packing" --frames 1 run.h5 one.vtp
    /usr/bin/python3 "$here/check_export.py" vtp run.h5 1 one.vtp
    [ "$(ls)" = "$(printf 'one.vtp\nrun.h5\nrun.xdmf')" ]
}

@test "several frames become numbered VTP files and a PVD with their times" {
    "$export_packing" run.h5 series.vtp
    /usr/bin/python3 "$here/check_export.py" vtp run.h5 0,1,2 series_0000.vtp series_0001.vtp series_0002.vtp
    /usr/bin/python3 "$here/check_export.py" pvd run.h5 0,1,2 series.pvd
    [ ! -e series.vtp ]
}

@test "an output named .pvd is written even for one frame" {
    "$export_packing" --frames last run.h5 last.pvd
    /usr/bin/python3 "$here/check_export.py" pvd run.h5 2 last.pvd
    /usr/bin/python3 "$here/check_export.py" vtp run.h5 2 last_0002.vtp
}

@test "first and last choose one frame of a dump" {
    "$export_packing" --frames first run.h5 first.dump
    "$export_packing" --frames last run.h5 last.dump
    /usr/bin/python3 "$here/check_export.py" dump run.h5 0 first.dump
    /usr/bin/python3 "$here/check_export.py" dump run.h5 2 last.dump
}

@test "a packing without objects gets object 0 in the dump and no such array in the VTP" {
    /usr/bin/python3 -c "import h5py; del h5py.File('run.h5', 'r+')['particles/all/object']"
    "$export_packing" run.h5 run.dump
    "$export_packing" --frames 0 run.h5 one.vtp
    /usr/bin/python3 "$here/check_export.py" dump run.h5 0,1,2 run.dump
    /usr/bin/python3 "$here/check_export.py" vtp run.h5 0 one.vtp
}

@test "spheres of many radii are exported with their own" {
    /usr/bin/python3 -c "import h5py; h5py.File('run.h5', 'r+')['particles/all/radius'] = [0.4, 0.5, 0.6, 0.7, 0.1, 1 / 3, 1]"
    "$export_packing" run.h5 run.dump
    "$export_packing" --frames 1 run.h5 one.vtp
    /usr/bin/python3 "$here/check_export.py" dump run.h5 0,1,2 run.dump
    /usr/bin/python3 "$here/check_export.py" vtp run.h5 1 one.vtp
}

@test "an unknown extension is wrong usage" {
    run "$export_packing" run.h5 run.xyz
    echo "$output"
    [ "$status" -eq 2 ]
    [[ "$output" == *"must end in .dump, .vtp or .pvd"* ]]
    [ ! -e run.xyz ]
}

@test "a word that names no frame is wrong usage" {
    run "$export_packing" --frames middle run.h5 run.dump
    [ "$status" -eq 2 ]
    [[ "$output" == *"give all, first, last or a number from 0"* ]]
}

@test "a frame beyond the end is refused" {
    run "$export_packing" --frames 3 run.h5 run.dump
    [ "$status" -eq 1 ]
    [[ "$output" == *"the file has frames 0 to 2"* ]]
    [ ! -e run.dump ]
}

@test "a series on a full disk leaves nothing behind" {
    "$TOMODEM_BIN/../tests/write_sample_run" 5000 6 big.h5
    mkdir disk
    mount -t tmpfs -o size=1m tmpfs disk 2> mount.txt || skip "no permission to mount a small tmpfs"
    run "$export_packing" big.h5 disk/series.vtp
    echo "$output"
    left=$(ls -A disk)
    run "$export_packing" big.h5 disk/all.dump
    left=$left$(ls -A disk)
    umount disk
    echo "$output"
    [ "$status" -eq 1 ]
    [[ "$output" == "export_packing: cannot write 'disk/all.dump': No space left on device" ]]
    [ -z "$left" ]
}

@test "what was computed of the particles is in the dump and in the VTP" {
    "$TOMODEM_BIN/../tests/write_sample_run" 7 3 plain.h5 fields.h5
    "$export_packing" fields.h5 fields.dump
    /usr/bin/python3 "$here/check_export.py" dump fields.h5 0,1,2 fields.dump
    "$export_packing" --frames 2 fields.h5 fields.vtp
    /usr/bin/python3 "$here/check_export.py" vtp fields.h5 2 fields.vtp
    grep -q "ITEM: ATOMS id type x y z radius object pressure stress_xx" fields.dump
}
