bats_require_minimum_version 1.5.0
load ../metrics/common

@test "a lattice cube has its volume and area in every format" {
    "$synthetic_run" run.h5 cells=6
    for extension in stl ply vtp obj; do
        "$TOMODEM_BIN/mesh_recon" run.h5 "mesh.$extension" --frame 0 --probe-radius 1mm --json out.json
        close "$(value volume out.json)" 216 1e-9
        close "$(value area out.json)" 216 1e-9
        [ "$(value components out.json)" -eq 1 ]
        [ "$(value particles out.json)" -eq 343 ]
        /usr/bin/python3 - "mesh.$extension" <<'PYTHON'
import sys, vtk
kind = {"stl": vtk.vtkSTLReader, "ply": vtk.vtkPLYReader, "vtp": vtk.vtkXMLPolyDataReader,
        "obj": vtk.vtkOBJReader}[sys.argv[1][-3:]]
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
    fails 1 "--frame 9: the file has frames 0 to" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --frame 9
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
    fails 1 "its particles carry no object numbers" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --object 1
    fails 1 "give a larger probe radius" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --probe-radius 0.1mm
    fails 1 ".stl" "$TOMODEM_BIN/mesh_recon" run.h5 out.off
    fails 1 "--frame 9: the file has frames 0 to" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --frame 9
    fails 1 "no objects in the sample" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --each-object
    fails 1 "larger than the particles to wrap" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --probe-radius 15mm
    fails 1 "give --frames all" "$TOMODEM_BIN/mesh_recon" run.h5 out.pvd
    fails 1 "frame 0: a ball of" "$TOMODEM_BIN/mesh_recon" run.h5 out.pvd --frames all --probe-radius 0.1mm
    fails 2 "exclude each other" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --frame 1 --frames all
    fails 2 "exclude each other" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --species 1 --object 1
    fails 2 "--probe-radius" "$TOMODEM_BIN/mesh_recon" run.h5 out.stl --probe-radius 0mm
    fails 1 "none.h5" "$TOMODEM_BIN/mesh_recon" none.h5 out.stl
    [ -z "$(ls out.* out_* 2>/dev/null)" ]
}

@test "all frames are a series that ParaView opens, with a row for each body" {
    "$synthetic_run" run.h5 cells=14 objects=1 frames=3
    "$TOMODEM_BIN/mesh_recon" run.h5 objects.pvd --each-object --frames all --probe-radius 0.6mm --bodies objects.csv --json all.json
    [ "$(ls objects_*.vtp | wc -l)" -eq 3 ]
    /usr/bin/python3 - <<'PYTHON'
import csv, json, vtk
import xml.etree.ElementTree as xml
sets = xml.parse("objects.pvd").getroot().findall("./Collection/DataSet")
assert [round(float(s.get("timestep")), 9) for s in sets] == [0, 175, 350]
rows = list(csv.DictReader(open("objects.csv")))
assert [(r["frame [-]"], r["object [-]"]) for r in rows] == [(str(f), str(o)) for f in range(3) for o in (1, 2, 3)]
for frame, s in enumerate(sets):
    reader = vtk.vtkXMLPolyDataReader(); reader.SetFileName(s.get("file")); reader.Update()
    numbers = reader.GetOutput().GetCellData().GetArray("object")
    for number in (1, 2, 3):
        cut = vtk.vtkThreshold(); cut.SetInputConnection(reader.GetOutputPort())
        cut.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "object")
        cut.SetLowerThreshold(number); cut.SetUpperThreshold(number)
        surface = vtk.vtkGeometryFilter(); surface.SetInputConnection(cut.GetOutputPort())
        mass = vtk.vtkMassProperties(); mass.SetInputConnection(surface.GetOutputPort())
        row = rows[3 * frame + number - 1]
        assert abs(mass.GetVolume() / float(row["volume [mm^3]"]) - 1) < 1e-6, (number, mass.GetVolume(), row)
        assert abs(mass.GetSurfaceArea() / float(row["area [mm^2]"]) - 1) < 1e-6
bodies = json.load(open("all.json"))["bodies"]
assert len(bodies) == 9 and all(b["genus"] == 0 and b["euler_characteristic"] == 2 for b in bodies)
PYTHON
}

@test "a series of another format has its frames and no collection" {
    "$synthetic_run" run.h5 frames=2
    "$TOMODEM_BIN/mesh_recon" run.h5 mesh.stl --frames all
    [ "$(ls mesh*)" = "$(printf 'mesh_0000.stl\nmesh_0001.stl')" ]
}

@test "a sample without pores has an empty surface of them, and a line says so" {
    "$synthetic_run" run.h5
    run "$TOMODEM_BIN/mesh_recon" run.h5 pores.vtp --pores --frame 0
    [ "$status" -eq 0 ]
    [[ "$output" == *"there is no pore"* ]]
}

@test "the corrected envelope encloses the corrected volume" {
    "$synthetic_run" run.h5 cells=12
    "$TOMODEM_BIN/mesh_recon" run.h5 mesh.vtp --frame 0 --correct-envelope --json out.json
    close "$(value volume out.json)" 1728 1e-9
    close "$(value volume_corrected out.json)" 2197 1e-9
    /usr/bin/python3 - <<'PYTHON'
import vtk
reader = vtk.vtkXMLPolyDataReader(); reader.SetFileName("mesh.vtp")
mass = vtk.vtkMassProperties(); mass.SetInputConnection(reader.GetOutputPort())
assert abs(mass.GetVolume() / 2197 - 1) < 1e-6, mass.GetVolume()
PYTHON
}
