#!/usr/bin/env bats
# Pages of runs in which everything is known beforehand, opened in a real browser without a screen.

bats_require_minimum_version 1.5.0

setup_file() {
    here=$TOMODEM_SOURCE/tests/tools/report
    cd "$BATS_FILE_TMPDIR" || exit 1
    mkdir pieces
    "$here/write_run.py" run.h5
    export MPLCONFIGDIR=$BATS_FILE_TMPDIR/matplotlib
    "$TOMODEM_BIN/report" run.h5 run.html --with pieces --quiet
}

setup() {
    PATH=$TOMODEM_BIN:$PATH
    unset DISPLAY WAYLAND_DISPLAY
    export MPLCONFIGDIR=$BATS_FILE_TMPDIR/matplotlib
    here=$TOMODEM_SOURCE/tests/tools/report
    made=$BATS_FILE_TMPDIR
    cd "$BATS_TEST_TMPDIR" || exit 1
}

check() { "$here/check_page.py" "$@"; }
needs_browser() { command -v chromium >/dev/null || skip "there is no chromium here"; }
one_line() { [ "$(wc -l <<<"$stderr")" -eq 1 ]; }
said() { [[ $stderr == *"$1"* ]] || { echo "said: $stderr"; return 1; }; }

@test "the page loads without a complaint and asks the network for nothing, on a laptop and on a phone" {
    needs_browser
    check loads "$made/run.html"
}

@test "the view draws, turns and zooms by the mouse; frames, switches and opacity change what is seen" {
    needs_browser
    check view "$made/run.html"
}

@test "the pore that closes is an event, with the strain and the place where it does" {
    needs_browser
    grep -q '1 event</h3>' "$made/run.html"
    check event "$made/run.html"
}

@test "the page says what the tables say" {
    # 99.6 MPa: 100 (1 - exp(-strain / 0.05)) over strains 0.25 to 0.3.
    grep -qE '<b>99\.(5[5-9]|6)[0-9]* MPa</b><span>flow stress' "$made/run.html"
    grep -q '<b>1 %</b><span>equilibrium error' "$made/run.html"
    for section in view pictures measures topology errors costs commands; do grep -q "<h2 id=$section>" "$made/run.html"; done
    [ "$(grep -o 'src="data:image/png;base64,' "$made/run.html" | wc -l)" -eq 6 ]
}

@test "a sample without curves, objects and pores has a sensible page too" {
    needs_browser
    "$here/write_run.py" sample.h5 --sample
    run -0 --separate-stderr report sample.h5 sample.html
    [ -z "$stderr" ]
    check loads sample.html
    for section in view pictures measures topology errors scene; do grep -q "<h2 id=$section>" sample.html; done
    grep -q "Not known: the file does not hold a scene" sample.html
    /usr/bin/python3 - <<'END'
import re
words = re.sub(r"<(script|style).*?</\1>|data:[^\"]*", "", open("sample.html").read(), flags=re.S)
assert not re.search(r"\b(nan|None|inf)\b", words, re.I), words
END
}

@test "a packing has a page, with what it cost" {
    packgen brick.h5 --particles 800 --density 0.64 --json brick.json --quiet
    run -0 --separate-stderr report brick.h5 brick.html --quiet
    [ -z "$stderr" ]
    grep -q '<td>packgen</td>' brick.html
}

@test "what is there is used again, what is older than the run is made again" {
    cp -a "$made"/{run.h5,pieces} .
    touch -d "1 day ago" run.h5
    report run.h5 again.html --with pieces --json again.json --quiet
    grep -q '"pieces_made": 0' again.json
    rm pieces/equilibrium.csv
    report run.h5 again.html --with pieces --json again.json --quiet
    grep -q '"pieces_made": 1' again.json
    touch run.h5
    report run.h5 again.html --with pieces --json again.json --quiet
    grep -q '"pieces_reused": 0' again.json
}

@test "pieces of another run are not taken for this one's" {
    cp "$made/run.h5" other.h5
    cp -a "$made/pieces" .
    touch -d "1 minute ago" other.h5
    report other.h5 other.html --with pieces --quick --json other.json --quiet
    grep -q '"pieces_reused": 0' other.json
}

@test "a run that is named as a measure keeps its own summary" {
    cp "$made/run.h5" pores.h5
    echo '{"tool": "solve", "command_line": "solve a.h5 b.toml pores.h5", "wall_seconds": 1, "cpu_seconds": 1, "peak_bytes": 1}' \
        >pores.json
    cp pores.json kept.json
    run -1 --separate-stderr report pores.h5 page.html --with .
    one_line
    said "'pores.json' is a summary of solve, and would be written over by that of pores"
    cmp pores.json kept.json
    [ ! -e page.html ]
}

@test "the solver's summary beside the run gives the cost, a summary of something else does not" {
    /usr/bin/python3 - "$made/run.h5" <<'END'
import h5py, shutil, sys
shutil.copy(sys.argv[1], "run.h5")
with h5py.File("run.h5", "a") as file:
    file["parameters/tomodem/command_line"] = "solve sample.h5 scene.toml run.h5"
    file["parameters/tomodem/tool"] = "solve"
    file["parameters/tomodem/scene"] = "seed_radius = 0.5\n[phase.steel]\nlabel = 1\n[phase.glass]\nlabel = 2\n"
END
    summary() {
        printf '{"tool": "%s", "command_line": "%s", "wall_seconds": 83, "cpu_seconds": 160, "peak_bytes": 104857600,
                 "steps": 12345, "time_step": 0.02, "processes": 2, "particles_lost": 3}' "$1" "$2"
    }
    summary solve "solve other.h5 scene.toml other_run.h5" >old.json
    report run.h5 run.html --quick --quiet
    run -0 grep -c 'keep the summary of' run.html
    summary solve "solve sample.h5 scene.toml run.h5" >run.json
    run -0 --separate-stderr report run.h5 run.html --quick --quiet
    said "warning: 3 particles were lost"
    grep -q '>1 min 23 s<' run.html
    grep -q "12.345 time steps of 0.02 s on 2 processes" run.html
    grep -q "glass" run.html
}

@test "a measure that cannot be made is said, and the page is made without it" {
    mkdir bin
    cp "$TOMODEM_BIN/report" bin/
    ln -s "$TOMODEM_BIN"/* bin/ 2>/dev/null || true
    rm bin/topology
    printf '#!/bin/sh\necho "topology: broken on purpose" >&2\nexit 1\n' >bin/topology
    chmod +x bin/topology
    run -0 --separate-stderr bin/report "$made/run.h5" page.html
    said "report: warning: Without topology: topology: broken on purpose"
    grep -q "broken on purpose" page.html
    rm bin/topology
    run -1 --separate-stderr bin/report "$made/run.h5" none.html
    one_line
    said "the executable topology is not at"
    [ ! -e none.html ]
}

@test "a new measure beside the tools is a section of the page, with its heading, values, units and plot" {
    mkdir bin
    cp "$TOMODEM_BIN/report" bin/
    ln -s "$TOMODEM_BIN"/* bin/ 2>/dev/null || true
    cp "$here/new_measure" bin/sample_height
    rm bin/tools.json
    run -1 --separate-stderr bin/report "$made/run.h5" page.html
    one_line
    said "the list of the tools is not at "
    "$TOMODEM_SOURCE/tools/launcher/list_tools" bin >bin/tools.json
    run -0 --separate-stderr bin/report "$made/run.h5" page.html --with pieces --quiet
    [ -z "$stderr" ]
    /usr/bin/python3 - <<'END'
import json
import pathlib
import re

page = pathlib.Path("page.html").read_text()
section = re.search(r"<figure class=measure id=.measure-sample_height.>.*?</figure>", page, re.S).group()
assert "<h3>Height &lt;of&gt; the sample</h3>" in section
height = json.loads(pathlib.Path("pieces/sample_height.json").read_text())["height_last"]
results = dict(re.findall("<dt>(.*?)</dt><dd>(.*?)</dd>", section))
assert results == {"height at the end": f"{0.1 * height:.4g} cm", "frames measured": "5"}, results
assert "<svg" in section
assert f"<b>{0.1 * height:.4g} cm</b><span>height at the end</span>" in page
END
    # A sample has no curves to measure it by: nothing is said.
    "$here/write_run.py" sample.h5 --sample
    run -0 --separate-stderr bin/report sample.h5 sample.html --quiet
    [ -z "$stderr" ]
    run -1 grep -q 'measure-sample_height' sample.html
}

@test "bad input gives one line and no page" {
    echo nonsense >broken.h5
    run -1 --separate-stderr report broken.h5 page.html
    one_line
    said "report: cannot read 'broken.h5': it is no run or sample"
    run -1 --separate-stderr report nowhere.h5 page.html
    one_line
    said "report: cannot read RUN 'nowhere.h5': there is no such file or folder"
    run -1 --separate-stderr report "$made/run.h5" nowhere/page.html
    one_line
    said "folder 'nowhere' does not exist; create it first"
    run -1 --separate-stderr report "$made/run.h5" page.html --with broken.h5
    one_line
    said "cannot use --with 'broken.h5' as a folder: File exists"
    [ ! -e page.html ]
}

@test "a command line that makes no sense is wrong usage" {
    cp "$made/run.h5" .
    for words in "run.h5" "run.h5 page.pdf" "run.h5 page.html --size 12x" "run.h5 page.html --nonsense" \
        "run.h5 page.html --threads 0" "run.h5 page.html --json" "run.h5 run.h5"; do
        # shellcheck disable=SC2086
        run -2 --separate-stderr report $words
        one_line
        said "report: "
    done
    run -0 report --help
    [[ $output == *"usage: report RUN REPORT [options]"*"examples:"* ]]
    run -0 report --version
    [[ $output == "report (tomodem) "* ]]
}

@test "stopped in the middle, it leaves nothing behind" {
    mkdir tmp
    TMPDIR=$PWD/tmp report "$made/run.h5" page.html --quiet 3>&- &
    sleep 0.8
    kill -TERM "$!"
    code=0
    wait "$!" || code=$?
    [ "$code" != 0 ]
    [ ! -e page.html ]
    [ -z "$(ls -A tmp)" ]
}
