#!/usr/bin/env bats
# The thresholds of self-contact: two labelled blocks crushed onto one another and pulled apart (thesis section 15.1).

setup() { cd "$BATS_TEST_TMPDIR" || exit 1; }

@test "of the new pairs across two blocks few are taken as internal, of those within one few as interface" {
    seq 3 | xargs -P 2 -I{} sh -ec "'$TOMODEM_BIN/../tests/two_blocks' 5000 {} 1e-3 > {}.json"
    /usr/bin/python3 - <<'END' >&3
import json
import numpy as np

runs = [json.load(open(f"{k}.json")) for k in (1, 2, 3)]
interface = np.array([100 * r["across_internal"] / r["new_across"] for r in runs])
internal = np.array([100 * r["within_interface"] / r["new_within"] for r in runs])
carried = [r["carried_by_the_other"] for r in runs]
print(f"# interface error {interface.mean():.2f} +- {interface.std(ddof=1):.2f} %")
print(f"# internal error {internal.mean():.2f} +- {internal.std(ddof=1):.2f} %")
print(f"# particles carried by the other block: {carried} of {runs[0]['particles']}")
assert interface.mean() < 1.5, interface
assert internal.mean() < 3, internal
END
}
