bats_require_minimum_version 1.5.0
load ../metrics/common

@test "the alpha shape of a random packing is VTK's" {
    "$TOMODEM_BIN/packgen" brick.h5 --particles 2000 --density 0.64 --quiet
    for probe in 0.8mm 1mm 2mm; do
        "$TOMODEM_BIN/mesh_recon" brick.h5 mesh.vtp --probe-radius $probe --json out.json --quiet
        /usr/bin/python3 "$TOMODEM_SOURCE/tests/tools/mesh_recon/against_vtk.py" brick.h5 mesh.vtp out.json
    done
}
