bats_require_minimum_version 1.5.0
load common
synthetic_fields="$TOMODEM_BIN/../tests/synthetic_fields"
crystallinity="$TOMODEM_BIN/crystallinity"

@test "a block of fcc is all fcc within its surface" {
    "$synthetic_fields" run.h5 lattice=1 cells=7 frames=1 scene=0 curves=0 field=0
    "$crystallinity" run.h5 out.csv --json out.json
    [ "$(value surface_last out.json)" -eq 508 ]  # outermost layers: of 1372, 864 lie inside
    [ "$(value fcc_last out.json)" = 1.0 ]
    [ "$(value crystalline_last out.json)" = 1.0 ]
}

@test "in a block of bcc those with all 14 neighbours are bcc: the layer under a cube face lacks one" {
    "$synthetic_fields" run.h5 lattice=2 cells=7 frames=1 scene=0 curves=0 field=0
    "$crystallinity" run.h5 out.csv --json out.json
    [ "$(value surface_last out.json)" -eq 254 ]
    close "$(value bcc_last out.json)" "$(/usr/bin/python3 -c 'print(250 / 432)')" 1e-12
}

@test "a periodic crystal has no surface and is all of its lattice, and fields say so of each particle" {
    "$synthetic_fields" brick.h5 periodic=1 frames=1 scene=0 curves=0 field=0 phases=2
    "$crystallinity" brick.h5 out.csv --fields fields.h5 --json out.json
    [ "$(value surface_last out.json)" -eq 0 ]
    [ "$(value fcc_last out.json)" = 1.0 ]
    [ "$(column "species [-]" out.csv | tr '\n' ',')" = ",1,2," ]
    [ "$(column "crystalline [-]" out.csv | tr '\n' ',')" = "1,1,1," ]
    /usr/bin/python3 -c '
import h5py
with h5py.File("fields.h5") as file:
    assert (file["particles/all/order/value"][:] == 1).all()
    assert (file["particles/all/surface/value"][:] == 0).all()'
}

@test "a simple cubic lattice and a random packing have almost none, and a random packing hardly a surface" {
    "$synthetic_fields" cubic.h5 periodic=1 frames=1 scene=0 curves=0 field=0 lattice=0
    "$crystallinity" cubic.h5 cubic.csv --json cubic.json
    [ "$(value crystalline_last cubic.json)" = 0.0 ]
    "$TOMODEM_BIN/packgen" brick.h5 --particles 2000 --density 0.64 --quiet
    "$crystallinity" brick.h5 brick.csv --json brick.json --threads 1
    "$crystallinity" brick.h5 again.csv --threads 3
    cmp brick.csv again.csv
    /usr/bin/python3 -c '
import json
out = json.load(open("brick.json"))
assert out["crystalline_last"] < 0.02 and out["surface_last"] <= 4, out'
}

@test "two particles all lie at the surface: there is no share" {
    "$synthetic_fields" two.h5 particles=2 field=0 frames=1 scene=0 curves=0
    run --separate-stderr "$crystallinity" two.h5 two.csv --json two.json
    [ "$status" -eq 0 ]
    [[ "$stderr" == *"all particles lie at the surface"* ]]
    [[ "$output" != *fcc* ]]
    [ "$(column "fcc [-]" two.csv)" = "" ]
}

@test "a frame that is not there and a box too small for its neighbours are refused" {
    "$synthetic_fields" run.h5 field=0
    refused 1 "frames 0 to 2" "$crystallinity" run.h5 out.csv --frames 9
    "$synthetic_fields" small.h5 periodic=1 frames=1 cells=2 scene=0 curves=0 field=0
    refused 1 "half of the shortest periodic edge" "$crystallinity" small.h5 out.csv --fields fields.h5
}
