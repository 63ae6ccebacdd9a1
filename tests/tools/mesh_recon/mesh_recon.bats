bats_require_minimum_version 1.5.0
load ../metrics/common

@test "a lattice cube has its volume and area in every format" {
    "$synthetic_run" run.h5 cells=6
    for extension in stl ply vtp; do
        "$TOMODEM_BIN/mesh_recon" run.h5 "mesh.$extension" --frame 0 --probe-radius 1mm --json out.json
        close "$(value volume out.json)" 216 1e-9
        close "$(value area out.json)" 216 1e-9
        [ "$(value components out.json)" -eq 1 ]
        [ "$(value particles out.json)" -eq 343 ]
        /usr/bin/python3 - "mesh.$extension" <<'PYTHON'
import sys, vtk
kind = {"stl": vtk.vtkSTLReader, "ply": vtk.vtkPLYReader, "vtp": vtk.vtkXMLPolyDataReader}[sys.argv[1][-3:]]
reader = kind(); reader.SetFileName(sys.argv[1])
edges = vtk.vtkFeatureEdges(); edges.SetInputConnection(reader.GetOutputPort())
edges.FeatureEdgesOff(); edges.BoundaryEdgesOn(); edges.NonManifoldEdgesOn(); edges.ManifoldEdgesOff(); edges.Update()
assert edges.GetOutput().GetNumberOfCells() == 0, "open or non-manifold edges"
mass = vtk.vtkMassProperties(); mass.SetInputConnection(reader.GetOutputPort())
assert abs(mass.GetVolume() / 216 - 1) < 1e-5, mass.GetVolume()
PYTHON
    done
}

@test "the last frame is meant where none is given" {
    "$synthetic_run" run.h5 cells=6 volume_factor=0.9 strain=0.1
    "$TOMODEM_BIN/mesh_recon" run.h5 mesh.stl --json last.json
    close "$(value volume last.json)" 194.4 1e-9
    [ "$(value probe_radius last.json)" = 1.0 ]
    fails 1 "there is no frame 9" "$TOMODEM_BIN/mesh_recon" run.h5 out.csv --frame 9
}

@test "a species is the sum of its objects" {
    "$synthetic_run" run.h5 cells=14 objects=1
    "$TOMODEM_BIN/mesh_recon" run.h5 phase.ply --species 2 --frame 0 --probe-radius 0.5mm --json phase.json
    "$TOMODEM_BIN/mesh_recon" run.h5 one.ply --object 1 --frame 0 --probe-radius 0.5mm --json one.json
    "$TOMODEM_BIN/mesh_recon" run.h5 two.ply --object 2 --frame 0 --probe-radius 0.5mm --json two.json
    "$TOMODEM_BIN/mesh_recon" run.h5 three.ply --object 3 --frame 0 --probe-radius 0.5mm --json three.json
    [ "$(value components phase.json)" -eq 3 ]
    close "$(value volume phase.json)" "$(/usr/bin/python3 -c 'import json
print(sum(json.load(open(n + ".json"))["volume"] for n in ("one", "two", "three")))')" 1e-9
    close "$(value volume one.json)" 268 0.15
    close "$(value volume three.json)" 0.125 1e-9
}

@test "bad requests are refused with one line and no mesh" {
    "$synthetic_run" run.h5
    fails 1 "no particle of species 5 in the sample; it has 1" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --species 5
    fails 1 "objects are not told apart" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --object 1
    fails 1 "give a larger probe radius" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --probe-radius 0.1mm
    fails 1 ".stl" "$TOMODEM_BIN/mesh_recon" run.h5 out.obj
    fails 2 "exclude each other" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --species 1 --object 1
    fails 2 "--probe-radius" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --probe-radius 0mm
    fails 1 "none.h5" "$TOMODEM_BIN/mesh_recon" none.h5 out.stl
    [ -z "$(ls out.* 2>/dev/null)" ]
}
