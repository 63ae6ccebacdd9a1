#!/usr/bin/env bats
# A spherical pore in a cube, crushed until it closes and pulled (thesis section 15.2): self-contact keeps its surface.

setup_file() {
    export PATH="$TOMODEM_BIN:$PATH"
    cd "$BATS_FILE_TMPDIR" || exit 1
}

setup() { cd "$BATS_FILE_TMPDIR" || exit 1; }

# scene NAME CONTACT
scene() {
    cat > "$1.toml" <<END
[phase.a]
label = 1
law = "trilin"
repulsive_stiffness = 1.42e9
natural_period = 1
[contact]
$2
[load]
steps = [ { strain = -0.6, rate = 1e-3 }, { strain = 0.0, rate = 1e-3 } ]
[accuracy]
time_step = 0.1
frames = 12
END
}

# pore RELATIVE_RADIUS PARTICLES: runs tracked, welded and healed
pore() {
    packgen brick.h5 --particles "$2" --density 0.74 --quiet
    "$TOMODEM_SOURCE/tests/physics/drill_pore.py" brick.h5 pore.h5 "$1"
    scene tracked 'self_contact = true'
    scene healed 'self_contact = true
healing_time = "20 s"'
    scene welded 'self_contact = false'
    relax pore.h5 tracked.toml relaxed.h5 --quiet
    printf 'tracked\nhealed\nwelded\n' | xargs -P 2 -I{} solve relaxed.h5 {}.toml {}.h5 --quiet
    "$TOMODEM_SOURCE/tests/physics/pore_volume.py" tracked.h5 healed.h5 welded.h5 > volumes.json
}

# check: closed at the end of compression; open at the end with self-contact, closed without it and when healed
check() {
    /usr/bin/python3 - "$1" <<'END' >&3
import json
import sys

volumes = json.load(open("volumes.json"))
share = {name: (crushed / start, pulled / start) for name, (start, crushed, pulled) in volumes.items()}
for name, (crushed, pulled) in share.items():
    print(f"# pore of r/a = {sys.argv[1]}, {name}: {crushed:.1%} of its volume at strain -0.6, {pulled:.1%} back at 0")
assert share["tracked"][0] < 0.1, "the pore does not close"
assert share["tracked"][1] > 0.3, "the pore does not open again"
assert share["welded"][1] < 0.02 and share["healed"][1] < 0.02, "a welded pore opens"
END
}

@test "a pore of r/a = 0.30 closes and opens again, and stays closed without self-contact or once it has healed" {
    pore 0.30 20000
    check 0.30
}

@test "a pore of r/a = 0.15 closes and opens again, and stays closed without self-contact or once it has healed" {
    pore 0.15 50000
    check 0.15
}
