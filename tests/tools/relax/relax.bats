bats_require_minimum_version 1.5.0
# relax: when it ends, and what is left when it is stopped.

load common

@test "a sample comes to rest: both ratios within their limits, whatever the number of processes" {
    packgen brick.h5 --particles 2000 --density 0.70 --quiet
    make_scene scene.toml
    relax brick.h5 scene.toml one.h5 --json one.json --quiet
    mpirun --oversubscribe -np 2 "$TOMODEM_BIN/relax" brick.h5 scene.toml two.h5 --json two.json --quiet
    /usr/bin/python3 - <<'END'
import json
import h5py
import numpy as np

one, two = (json.load(open(name + ".json")) for name in ("one", "two"))
for summary in one, two:
    assert summary["at_rest"] == 1, summary
    assert summary["energy_ratio"] <= 1e-5 and summary["force_balance"] <= 1e-3, summary
    assert 15 < summary["periods"] < 200, summary
size = [h5py.File(name)["particles/all/position/value"][0].std(axis=0) for name in ("one.h5", "two.h5")]
assert np.allclose(*size, rtol=2e-3), size
END
}

@test "tighter limits take longer and leave less" {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    make_scene scene.toml
    relax brick.h5 scene.toml loose.h5 --json loose.json --quiet --energy-ratio 1e-2 --force-balance 1
    relax brick.h5 scene.toml tight.h5 --json tight.json --quiet --energy-ratio 1e-8 --force-balance 1e-5
    /usr/bin/python3 - <<'END'
import json

loose, tight = (json.load(open(name + ".json")) for name in ("loose", "tight"))
assert loose["periods"] < tight["periods"]
assert loose["energy_ratio"] > 1e-5 and tight["energy_ratio"] <= 1e-8 and tight["force_balance"] <= 1e-5
END
}

@test "at its cap it warns in one line how far it is, and writes what it has" {
    packgen brick.h5 --particles 500 --density 0.70 --quiet
    make_scene scene.toml
    refused 0 "the sample is not at rest after 2 natural periods: kinetic over elastic energy is" \
        relax brick.h5 scene.toml relaxed.h5 --max-periods 2 --quiet
    [ -e relaxed.h5 ]
}

@test "stopped by a signal it says that nothing is kept" {
    packgen brick.h5 --particles 2000 --density 0.70 --quiet
    make_scene scene.toml
    relax brick.h5 scene.toml relaxed.h5 --quiet --energy-ratio 1e-30 --max-periods 1e6 2> stderr.txt & process=$!
    sleep 2
    kill -TERM $process
    status=0
    wait $process || status=$?
    cat stderr.txt
    [ "$status" -eq 1 ]
    [ "$(cat stderr.txt)" = "relax: stopped by SIGTERM while the sample was relaxed: nothing is kept of this relaxation" ]
    [ ! -e relaxed.h5 ]
}

@test "NORTON and TRILIN come to rest too" {
    packgen brick.h5 --particles 1000 --density 0.64 --quiet
    make_scene norton.toml norton
    relax brick.h5 norton.toml relaxed.h5 --json norton.json --quiet
    packgen brick.h5 --particles 1000 --density 0.74 --quiet
    make_scene trilin.toml trilin
    sed -i 's/M = 2.45e-3/M = 0.0714/' trilin.toml
    relax brick.h5 trilin.toml relaxed.h5 --json trilin.json --quiet
    grep -q '"at_rest": 1' norton.json
    grep -q '"at_rest": 1' trilin.json
}

@test "relax says how much the sample changed, and warns where its parts are too thin to keep their shape" {
    packgen brick.h5 --particles 2000 --density 0.70 --quiet
    make_scene scene.toml
    relax brick.h5 scene.toml rest.h5 --json rest.json --quiet
    /usr/bin/python3 -c "import json; r = json.load(open('rest.json')); assert 5 < r['box_volume_change'] < 12, r"
    /usr/bin/python3 - <<'PYTHON'
import shutil
import h5py
import numpy as np
shutil.copy("brick.h5", "thin.h5")
with h5py.File("thin.h5", "a") as file:
    # A thin cross of struts is what is left of the brick.
    everything = file["particles/all"]
    position = everything["position/value"][0]
    edges = everything["box/edges"][:]
    near = np.abs(position / edges - 0.5) < 0.06
    keep = near.sum(axis=1) >= 2
    for name in ("species", "id"):
        values = everything[name][:][keep]
        del everything[name]
        everything[name] = values
    del everything["position/value"]
    everything["position/value"] = position[keep][None]
    everything["box"].attrs["boundary"] = [b"none"] * 3
PYTHON
    run -0 --separate-stderr relax thin.h5 scene.toml collapsed.h5
    [[ "$stderr" == *"the sample changed its box by -"*"too thin to keep their shape"* ]]
}
