#!/usr/bin/env bats
bats_require_minimum_version 1.5.0
# The size of a voxel where the file says a wrong one.

setup() {
    cd "$BATS_TEST_TMPDIR" || return 1
    PATH=$TOMODEM_BIN:$PATH
    # As ImageJ writes a stack whose size nobody set: 100 pixels per inch.
    /usr/bin/python3 - <<'PYTHON'
import numpy as np
from tifffile import imwrite
stack = np.zeros((20, 30, 40), np.uint8)
stack[5:15, 5:20, 5:30] = 1
def imagej(name, pixels, unit):
    imwrite(name, stack, imagej=True, resolution=(pixels, pixels), metadata={"axes": "ZYX", "unit": unit, "spacing": 1 / pixels})
imagej("inch.tif", 100, "inch")
imagej("dpi72.tif", 72, "inch")
imagej("real.tif", 1 / 2.5, "um")
PYTHON
}

@test "a size that is 100 or 72 pixels per inch is used with a warning that says what it is" {
    run -0 --separate-stderr volume_info inch.tif
    echo "$stderr"
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == *"254 um is 100 pixels per inch"*"give --voxel-size with --override-voxel-size"* ]]
    [[ "$output" == *"voxel_size_x: 254 um"* ]]
    run -0 --separate-stderr volume_info dpi72.tif
    [[ "$stderr" == *"352.8 um is 72 pixels per inch"* ]]
    run -0 --separate-stderr volume_info real.tif
    [ -z "$stderr" ]
}

@test "a contradiction is refused, names both sizes and the option that overrides, and following it works" {
    run -1 --separate-stderr volume_info inch.tif --voxel-size 3um
    echo "$stderr"
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == *"its voxels are 254 x 254 x 254 um, but 3 um are given"*"100 pixels per inch"*"--override-voxel-size"* ]]
    run -0 --separate-stderr volume_info inch.tif --voxel-size 3um --override-voxel-size
    echo "$stderr"
    [ "${#stderr_lines[@]}" -eq 1 ]
    [[ "$stderr" == *"254 x 254 x 254 um"*"taken as 3 x 3 x 3 um"* ]]
    [[ "$output" == *"voxels of 3 x 3 x 3 um, as given"* && "$output" == *"extent_x: 0.12 mm"* ]]
    run -0 --separate-stderr volume_info inch.tif --voxel-size 3um --slice-spacing 5um --override-voxel-size
    [[ "$stderr" == *"taken as 3 x 3 x 5 um"* && "$output" == *"extent_z: 0.1 mm"* ]]
    # Where the sizes agree there is nothing to say.
    run -0 --separate-stderr volume_info real.tif --voxel-size 2.5um --override-voxel-size
    [ -z "$stderr" ]
    run -2 --separate-stderr volume_info inch.tif --override-voxel-size
    [[ "$stderr" == *"needs the right size: --voxel-size"* ]]
}

@test "every tool that reads a volume has the option, plan hands it on, and so does the chain" {
    for tool in "$TOMODEM_BIN"/*; do
        "$tool" --help > help.txt 2>/dev/null || continue
        grep -q -- '--voxel-size' help.txt && grep -q -- '--raw-size' help.txt || continue
        echo "$tool" >> readers.txt
        grep -q -- '--override-voxel-size' help.txt || { echo "$tool has not"; return 1; }
    done
    for reader in volume_info vol2pack plan carve image_shapes compare_shapes grey_histogram denoise local_threshold separate_objects; do
        grep -q "/$reader\$" readers.txt
    done
    cat > scene.toml <<'TOML'
[phase.matrix]
label = 1
law = "bilin"
norton = { K = 100, M = 0.1 }
[load]
steps = [ { strain = -0.05, rate = 1e-3 } ]
TOML
    run -0 --separate-stderr plan inch.tif --voxel-size 3um --override-voxel-size --scene scene.toml --error 20% --of flow_stress
    echo "$output"
    grep -q -- 'vol2pack .*--voxel-size 0.003mm --override-voxel-size' <<< "$output"
    run -0 make -n --no-print-directory -f "$TOMODEM_SOURCE/pipelines/chain.mk" VOLUME=inch.tif VOXEL_SIZE=3um \
        OVERRIDE_VOXEL_SIZE=yes OUT=out BIN="$TOMODEM_BIN" out/image.json
    [[ "$output" == *"volume_info inch.tif --voxel-size 3um --override-voxel-size"* ]]
}

@test "vol2pack makes a sample of the size given" {
    packgen brick.h5 --particles 300 --density 0.7 --quiet
    vol2pack brick.h5 inch.tif sample.h5 --voxel-size 3um --override-voxel-size --pixels-per-seed 2 --quiet
    /usr/bin/python3 - <<'PYTHON'
import h5py
import numpy as np
with h5py.File("sample.h5") as file:
    position = file["particles/all/position/value"][0] if "value" in file["particles/all/position"] else file["particles/all/position"][:]
assert np.ptp(position[:, 0]) < 0.08 and position[:, 0].max() > 0.08, (position.min(0), position.max(0))
PYTHON
}
