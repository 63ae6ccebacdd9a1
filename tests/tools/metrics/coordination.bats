bats_require_minimum_version 1.5.0
load common
synthetic_fields="$TOMODEM_BIN/../tests/synthetic_fields"
coordination="$TOMODEM_BIN/coordination"

@test "a periodic fcc crystal has twelve contacts a particle, all of one overlap, and no rattlers" {
    "$synthetic_fields" brick.h5 periodic=1 frames=1 scene=0 curves=0 field=0
    "$coordination" brick.h5 out.csv --json out.json
    [ "$(value contacts_last out.json)" -eq $((864 * 6)) ]
    close "$(value mean_coordination_last out.json)" 12 1e-12
    close "$(value backbone_coordination_last out.json)" 12 1e-12
    [ "$(value rattlers_last out.json)" -eq 0 ]
    close "$(value mean_overlap_last out.json)" 0.02 1e-9
    close "$(value max_overlap_last out.json)" 0.02 1e-9
}

@test "the reach chooses what a contact is: bcc has 8 within the seeds and 14 within the crowns" {
    "$synthetic_fields" brick.h5 periodic=1 frames=1 scene=0 curves=0 field=0 lattice=2
    "$coordination" brick.h5 seeds.csv --json seeds.json
    "$coordination" brick.h5 crowns.csv --reach 1.5 --json crowns.json
    close "$(value mean_coordination_last seeds.json)" 8 1e-12
    close "$(value mean_coordination_last crowns.json)" 14 1e-12
    close "$(value mean_overlap_last crowns.json)" 0.02 1e-9
}

@test "phases and pairs of phases have rows of their own that add up to all" {
    "$synthetic_fields" run.h5 phases=2 field=0
    "$coordination" run.h5 out.csv --frames 1
    /usr/bin/python3 -c '
import csv
rows = {(r["species [-]"], r["other_species [-]"]): r for r in csv.DictReader(open("out.csv"))}
assert list(rows) == [("", ""), ("1", ""), ("2", ""), ("1", "1"), ("1", "2"), ("2", "1"), ("2", "2")], list(rows)
number = lambda key, name: float(rows[key][name + " [-]"])
total = sum(number(key, "contacts") for key in (("1", "1"), ("1", "2"), ("2", "2")))
assert total == number(("", ""), "contacts") > 1000
assert rows["1", "2"]["contacts [-]"] == rows["2", "1"]["contacts [-]"]
for label in "12":
    own = sum(number((label, other), "mean_coordination") for other in "12")
    assert abs(own - number((label, ""), "mean_coordination")) < 1e-9
rattlers = sum(number((label, ""), "rattlers") for label in "12")
assert rattlers == number(("", ""), "rattlers")'
}

@test "the contacts of each particle open in h5py and VTK, with the sums of the table" {
    "$synthetic_fields" run.h5 field=0 frames=2 strain=0.01
    "$coordination" run.h5 out.csv --fields fields.h5 --json out.json
    /usr/bin/python3 -c '
import h5py, json
result = json.load(open("out.json"))
with h5py.File("fields.h5") as file:
    particles = file["particles/all"]
    assert particles["coordination/value"][1].sum() == 2 * result["contacts_last"]
    assert particles["rattler/value"][1].sum() == result["rattlers_last"]
assert result["rows"][-1]["contacts"] == result["contacts_last"]'
    "$TOMODEM_BIN/export_packing" --frames last fields.h5 last.vtp
    /usr/bin/python3 -c '
import json
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
reader = vtkXMLPolyDataReader()
reader.SetFileName("last.vtp")
reader.Update()
contacts = reader.GetOutput().GetPointData().GetArray("coordination")
total = sum(contacts.GetValue(i) for i in range(contacts.GetNumberOfTuples()))
assert total == 2 * json.load(open("out.json"))["contacts_last"]'
}

@test "two particles touch once and are rattlers; the table is the same on one thread and three" {
    "$synthetic_fields" two.h5 particles=2 field=0 lattice=0
    "$coordination" two.h5 two.csv --frames first --json two.json
    [ "$(value contacts_last two.json)" -eq 1 ]
    [ "$(value rattlers_last two.json)" -eq 2 ]
    "$synthetic_fields" run.h5 field=0 phases=2 cells=8
    "$coordination" run.h5 one.csv --threads 1
    "$coordination" run.h5 three.csv --threads 3
    cmp one.csv three.csv
}

@test "a frame that is not there, a reach of zero and a file that is no run are refused" {
    "$synthetic_fields" run.h5 field=0
    refused 1 "frames 0 to 2" "$coordination" run.h5 out.csv --frames 3
    refused 2 "--reach" "$coordination" run.h5 out.csv --reach 0
    refused 2 "--frames" "$coordination" run.h5 out.csv --frames some
    echo text >text.h5
    refused 1 "text.h5" "$coordination" text.h5 out.csv --fields fields.h5
}
