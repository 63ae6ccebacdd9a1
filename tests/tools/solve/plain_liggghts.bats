#!/usr/bin/env bats
# The same law from a plain LIGGGHTS input script (docs/plain-liggghts.md).

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    here="$TOMODEM_SOURCE/docs/examples"
}

press() { LD_PRELOAD="$TOMODEM_LIB/libtomodem_liggghts.so" "$@" -var here "$here" -in "$here/two_plates.in" >log.txt 2>&1; }

@test "the example runs in the stock liggghts and balances the two plates" {
    press liggghts
    /usr/bin/python3 - <<'END'
import numpy as np

step, top, bottom = np.loadtxt("two_plates.txt").T
assert step[-1] == 20000
assert np.all(np.abs(top) > 1e6)
assert np.max(np.abs(top + bottom)) < 1e-3 * np.max(np.abs(top))
END
}

@test "it gives the same on two processes" {
    press liggghts
    mv two_plates.txt one.txt
    press mpirun --oversubscribe -np 2 liggghts
    cat one.txt two_plates.txt
    /usr/bin/python3 -c '
import numpy as np
one, two = np.loadtxt("one.txt"), np.loadtxt("two_plates.txt")
assert np.allclose(one[:8], two[:8], rtol=1e-4)'
}

@test "without the plugin the stock liggghts does not know the law" {
    run liggghts -var here "$here" -in "$here/two_plates.in"
    [ "$status" -ne 0 ]
    [[ "$output" == *"Invalid model"* ]]
}
