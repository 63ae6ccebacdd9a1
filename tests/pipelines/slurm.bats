#!/usr/bin/env bats
# A batch under a real Slurm of one node.

bats_require_minimum_version 1.5.0

setup_file() {
    . "$TOMODEM_SOURCE/tests/pipelines/common.bash"
    . "$TOMODEM_SOURCE/tests/pipelines/one_node_slurm.bash"
    export PATH=$PATH:/usr/sbin:/sbin
    for program in munged slurmctld slurmd sbatch; do
        command -v $program >/dev/null || skip "$program is not installed (packages/debian.txt)"
    done
    start_slurm "$BATS_FILE_TMPDIR/slurm"
    export SLURM_CONF
}

teardown_file() {
    . "$TOMODEM_SOURCE/tests/pipelines/one_node_slurm.bash"
    [ ! -e "$BATS_FILE_TMPDIR/slurm/slurm.conf" ] || stop_slurm "$BATS_FILE_TMPDIR/slurm"
}

setup() {
    . "$TOMODEM_SOURCE/tests/pipelines/common.bash"
    cd "$BATS_TEST_TMPDIR" || exit 1
    mkdir stacks
}

queue_is_empty() { [ -z "$(squeue -h)" ]; }

@test "a dry run shows the jobs and touches nothing" {
    make_stack stacks/one.tif 1
    run -0 pipeline slurm OUT=out NP=2 TIME=10 SBATCH=--account=a -n
    for part in "--array=1-1" "--ntasks=2 --time=10 --signal=B:USR1@120 --requeue" "--dependency=afterok" "--dependency=aftercorr" \
        "--dependency=afterany" "--account=a"; do
        [[ $output == *"$part"* ]]
    done
    [ ! -e out ]
    queue_is_empty
}

# halt_at_step STEP FOLDER: waits for the run and halts its processes behind that step; their ids on stdout
halt_at_step() {
    HDF5_USE_FILE_LOCKING=FALSE /usr/bin/python3 - "$@" <<'END'
import os
import pathlib
import signal
import subprocess
import sys
import time

import h5py

step, folder = int(sys.argv[1]), pathlib.Path(sys.argv[2])
reached, end = -1, time.monotonic() + 60
while reached < step:
    time.sleep(0.01)
    assert time.monotonic() < end, f"waited in vain for step {step}"
    try:
        with h5py.File(folder / "run.h5.partial") as file:
            reached = file["observables/strain/step"][:].max()
    except (OSError, KeyError):  # not there yet, or just being written
        pass
workers = subprocess.run(["pgrep", "-P", (folder / "run.pid").read_text().strip()], capture_output=True, text=True).stdout
for worker in workers.split():
    os.kill(int(worker), signal.SIGSTOP)
print(workers, end="")
END
}

@test "a task at its time limit is queued again and ends with the same run; a broken stack is listed; a job collects" {
    make_stack stacks/long.tif 1
    head -c 500 stacks/long.tif >stacks/broken.tif
    make_stack stacks/short.tif 2
    make_scene stacks/long.toml 4e-6
    make_scene stacks/short.toml 2e-4

    pipeline slurm OUT=out NP=2 TIME=1 WARNING=55 TIME_MEASURES=5
    # Halted in its middle until its time is over, the run is a long one on any machine.
    workers=$(halt_at_step 3000 out/long)
    # Meanwhile: what it would be without an end of time, on as many processes.
    pipeline batch OUT=whole NP=2 GOAL=run stack/long
    first_worker=${workers%%$'\n'*}
    warned() { (((0x$(sed -n 's/^ShdPnd:\t//p' "/proc/$first_worker/status") >> 9) & 1)); }
    wait_for 45 warned
    kill -CONT $workers

    wait_for 90 queue_is_empty || { squeue; false; }
    cat out/slurm/*.log
    # The task itself went on, not a job behind it.
    log=$(grep -l "long: near the end of its time; queued again" out/slurm/run-*.log)
    grep -q "^long: done" "$log"
    grep -q "stopped by SIGUSR1" out/long/log.txt
    grep -q "resuming at strain -0" out/long/log.txt
    same_run whole/long/run.h5 out/long/run.h5

    [ "$(value_of long status <out/batch.csv)" = "done" ]
    [ "$(value_of long processes <out/batch.csv)" = 2 ]
    [ "$(value_of short status <out/batch.csv)" = "done" ]
    [[ "$(value_of broken error <out/batch.csv)" == *"cannot read volume"* ]]
    grep -q 'href="long/report.html"' out/index.html
}
