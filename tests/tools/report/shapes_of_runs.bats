#!/usr/bin/env bats
# Every shape of run has its page: what a run does not have is one sentence in its place, and no warning.

bats_require_minimum_version 1.5.0

setup() {
    PATH=$TOMODEM_BIN:$PATH
    unset DISPLAY WAYLAND_DISPLAY
    export MPLCONFIGDIR=$BATS_FILE_TMPDIR/matplotlib
    here=$TOMODEM_SOURCE/tests/tools/report
    cd "$BATS_TEST_TMPDIR" || exit 1
}

# page NAME WORD...: writes NAME.h5 with these words, and its page; nothing is said of it on stderr
page() {
    "$here/write_shape.py" "$1.h5" "${@:2}"
    run -0 --separate-stderr report "$1.h5" "$1.html" --size 320x240 --quiet
    [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
}
loads() { if command -v chromium >/dev/null; then "$here/check_page.py" loads "$@"; fi; }
shows() { grep -qF -- "$2" "$1.html" || { echo "$1.html does not say: $2"; return 1; }; }
# No number that is none in what a reader sees.
sensible() {
    /usr/bin/python3 - "$@" <<'END'
import re, sys
for page in sys.argv[1:]:
    words = re.sub(r"<(script|style|svg).*?</\1>|data:[^\"]*", "", open(page).read(), flags=re.S)
    found = re.search(r".{40}\b(nan|None|inf|KeyError|by a fault)\b.{40}", words, re.S)
    assert not found, (page, found.group())
END
}

@test "no object, one object, two objects" {
    page none
    shows none "The sample has no objects"
    shows none "Shape factor, Shapes of the objects: the sample has no objects."
    shows none "There is no pore in frame 1."
    shows none "Nothing merged, split, opened or closed on the way"
    # The spread of one object does not exist, and is no result.
    page one --objects 1
    shows one "<h3>Shape factor</h3>"
    run -1 grep -q "scatter of the objects" one.html
    shows one "1 measured"
    page two --objects 2
    shows two "scatter of the objects"
    loads none.html one.html two.html
    sensible none.html one.html two.html
}

@test "more than a thousand objects, all of them in the table, their curves a choice that is stated" {
    page grains --edge 33 --grains
    [ "$(grep -o 'border-radius\|<td><i style="background:' grains.html | grep -c '<td>')" -ge 1331 ]
    shows grains "1331 measured"
    loads grains.html
    sensible grains.html
}

@test "one frame, of a run and of a sample" {
    page frame --frames 1
    shows frame "Not shown: there is one frame, and events are found between frames."
    shows frame "Volume of the envelope: there is one frame."
    page sample --frames 1 --curves none --objects 1
    shows sample "Stress and strain, Equilibrium, Control numbers of the packing: the file is a sample, without curves."
    shows sample "Not known: the file does not hold a scene."
    loads frame.html sample.html
    sensible frame.html sample.html
}

@test "a run without a curve of the stress" {
    page strain --curves strain
    shows strain "Stress and strain: the run has no curve stress_true and stress_engineering and equilibrium_error."
    shows strain "true strain reached"
    loads strain.html
    sensible strain.html
}

@test "a closed pore and an open one are on the page and in the cut, and no sentence denies them" {
    page closed --pore closed --objects 0
    shows closed "<td>closed</td>"
    page open --edge 12 --frames 1 --pore open
    shows open "<td>open</td>"
    # No event of closed pores, but the open one is flat at the end.
    page flat --edge 12 --pore open
    shows flat "pores, those with a mouth included 1 → 0"
    run -1 grep -q "Nothing merged" flat.html
    loads closed.html open.html flat.html
    sensible closed.html open.html flat.html
}

@test "an unfinished run is called that, with how far it came, and how to go on" {
    "$here/write_shape.py" run.h5.partial --unfinished --frames 3
    run -0 --separate-stderr report run.h5.partial run.html --quick --quiet
    [[ $stderr == "report: warning: Unfinished run: it has 3 of 5 frames. Every figure is of what there is." ]]
    shows run "unfinished run</span>"
    shows run "<title>tomodem: run (unfinished)</title>"
    touch run.h5.checkpoint
    run -0 --separate-stderr report run.h5.partial run.html --quick --quiet
    [[ $stderr == *"solve --resume goes on from the checkpoint beside it." ]]
    loads run.html
    # The name that it will have is not there yet.
    run -1 --separate-stderr report run.h5 other.html
    [[ $stderr == "report: cannot read RUN 'run.h5': this run is unfinished; give 'run.h5.partial', "* ]]
    [ ! -e other.html ]
}

@test "a run that solve was stopped in has a page" {
    packgen brick.h5 --particles 300 --density 0.64 --quiet
    printf '[phase.a]\nlabel = 1\nlaw = "bilin"\nnorton = { K = 95.9, M = 2.45e-3 }\n[load]\naxis = "z"\nsteps = [ { strain = -0.3, rate = 1e-3 } ]\n[accuracy]\nstrain_per_step = 2e-6\n' >scene.toml
    /usr/bin/python3 -c 'import h5py; f = h5py.File("brick.h5", "a"); f["particles/all/box"].attrs["boundary"] = [b"none"] * 3'
    solve brick.h5 scene.toml run.h5 --quiet 3>&- 2>solve.txt &
    for _ in $(seq 100); do [ ! -e run.h5.partial ] || break; sleep 0.1; done
    sleep 0.7
    kill -USR1 "$!"
    wait "$!" || true
    [ -e run.h5.checkpoint ] || { cat solve.txt; return 1; }
    run -0 --separate-stderr report run.h5.partial run.html --quick --quiet
    [[ $stderr == *"warning: Unfinished run: it has "*" frames and reached a true strain of -0."*" of -0.3."*"solve --resume"* ]]
    shows run "unfinished run</span>"
    sensible run.html
}

@test "a hundred thousand particles" {
    page large --edge 47 --frames 1 --curves none --pore closed
    loads large.html
    sensible large.html
    [ "$(stat -c %s large.html)" -lt 6000000 ]
}

@test "a summary that lacks a key, and a table that lacks a column, cost their own part alone" {
    mkdir pieces
    "$here/write_shape.py" run.h5 --objects 2 --pore closed
    report run.h5 whole.html --with pieces --size 320x240 --quiet
    /usr/bin/python3 - <<'END'
import glob, json, os
for path in glob.glob("pieces/*.json"):
    summary = json.load(open(path))
    kept = {key: summary[key] for key in ("tool", "version", "command_line", "wall_seconds", "cpu_seconds", "peak_bytes")}
    json.dump(kept, open(path, "w"))
for path in ("pieces/pores_each.csv", "pieces/shape_factor.csv"):
    lines = [line.split(",") for line in open(path)]
    open(path, "w").write("".join(",".join(cells[:5]) + "\n" for cells in lines))
open("pieces/topology_events.csv", "w").close()
END
    run -0 --separate-stderr report run.h5 run.html --with pieces --size 320x240 --json report.json --quiet
    [ -z "$stderr" ] || { echo "said: $stderr"; return 1; }
    grep -q '"pieces_made": 0' report.json
    shows run "Not shown: shape_factor.csv does not hold &#39;"
    shows run "Not shown: pores_each.csv does not hold &#39;"
    shows run "Not shown: topology_events.csv cannot be read"
    shows run "<h2 id=costs>"
    loads run.html
}

@test "a quick page is of the curves and two pictures, and shows what is there" {
    mkdir pieces
    "$here/write_shape.py" run.h5 --objects 1
    report run.h5 quick.html --quick --with pieces --size 320x240 --json quick.json --quiet
    [ "$(grep -o 'src="data:image/png;base64,' quick.html | wc -l)" = 2 ]
    shows quick "Pores, Contacts of the particles, Crystalline order: left out by --quick."
    shows quick "Not shown: left out by --quick."
    loads quick.html
    report run.h5 full.html --with pieces --size 320x240 --quiet
    report run.h5 quick.html --quick --with pieces --size 320x240 --json quick.json --quiet
    grep -q '"pieces_made": 0' quick.json
    run -1 grep -q "left out by --quick" quick.html
}

@test "measures of fewer frames say which, and all frames can be had" {
    "$here/write_shape.py" run.h5 --frames 14
    report run.h5 run.html --size 320x240 --frames 4 --quiet
    shows run "Measured in 4 of 14 frames: 0, 4, 9, 13."
    shows run "4 of 14 frames: 0, 4, 9, 13. Surfaces"
    report run.h5 run.html --size 320x240 --frames 20 --quiet
    run -1 grep -q "of 14 frames" run.html
}

@test "the title is the name of the image, or the one that is given" {
    mkdir -p scans/bone
    phantom_pores scans/bone/labels.tif --size 24 --voxel-size 10um --porosity 0.05 --median-diameter 80um --quiet
    packgen brick.h5 --particles 500 --density 0.7 --quiet
    vol2pack brick.h5 scans/bone/labels.tif sample.h5 --pixels-per-seed 1.5 --quiet
    report sample.h5 page.html --quick --quiet
    shows page "<h1>bone</h1>"
    report sample.h5 page.html --quick --title 'Casting <7>' --quiet
    shows page "<h1>Casting &lt;7&gt;</h1>"
}

@test "the summary of another sample that was cut from the same brick is not this one's" {
    for name in one two; do
        phantom_pores $name.tif --size 24 --voxel-size 10um --porosity 0.05 --median-diameter 80um --quiet
    done
    packgen brick.h5 --particles 500 --density 0.7 --quiet
    vol2pack brick.h5 one.tif a_other.h5 --pixels-per-seed 1.6 --json a_other.json --quiet
    vol2pack brick.h5 two.tif sample.h5 --pixels-per-seed 1.5 --json sample.json --quiet
    report sample.h5 page.html --quick --quiet
    run -0 grep -c "particles lost</td><td>0 of" page.html
    run -1 grep -q "one.tif" page.html
}

@test "a sample that was made anew since is not what the run was made of" {
    for name in one two; do
        phantom_pores $name.tif --size 24 --voxel-size 10um --porosity 0.05 --median-diameter 80um --quiet
    done
    printf '[phase.solid]\nlabel = 1\nlaw = "bilin"\nnorton = { K = 95.9, M = 2.45e-3 }\n[load]\nsteps = [ { strain = -0.05, rate = 1e-3 } ]\n' >scene.toml
    packgen brick.h5 --particles 500 --density 0.7 --quiet
    vol2pack brick.h5 one.tif sample.h5 --pixels-per-seed 1.5 --json sample.json --quiet
    relax sample.h5 scene.toml relaxed.h5 --quiet
    report relaxed.h5 page.html --quick --quiet
    shows page "<h1>one</h1>"
    vol2pack brick.h5 two.tif sample.h5 --pixels-per-seed 1.6 --json sample.json --quiet
    report relaxed.h5 page.html --quick --quiet
    shows page "<h1>relaxed</h1>"
    run -1 grep -q "two.tif" page.html
}
