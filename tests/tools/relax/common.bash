# Shared by the tests of relax and carve: scenes, and an image with one pore.

setup() {
    PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_TEST_TMPDIR" || exit 1
}

# make_scene FILE [LAW]
make_scene() {
    cat > "$1" <<END
[phase.a]
label = 1
law = "${2:-bilin}"
norton = { K = 95.9, M = 2.45e-3 }

[load]
steps = [ { strain = -0.1, rate = 1e-3 } ]
END
}

# make_pore FILE VOXELS DIAMETER [OPTION...]: one sphere of void, diameter in voxels of 10 um, in the middle
make_pore() {
    local file=$1 size=$2 diameter=$3
    shift 3
    local porosity
    porosity=$(/usr/bin/python3 -c "print(3.14159 / 6 * ($diameter / $size) ** 3)")
    phantom_pores "$file" --size "$size" --voxel-size 10um --porosity "$porosity" --median-diameter "$((10 * diameter))um" \
        --spread 0 --clusters 0 --gap $(((size - diameter) / 2 - 6)) --quiet "$@"
}

# refused STATUS TEXT COMMAND...: this exit status, one line on stderr that contains the text
refused() {
    local wanted=$1 text=$2
    shift 2
    local status=0
    "$@" 2> stderr.txt > stdout.txt || status=$?
    cat stderr.txt
    [ "$status" -eq "$wanted" ]
    [ "$(wc -l < stderr.txt)" -eq 1 ]
    grep -qF -- "$text" stderr.txt
}
