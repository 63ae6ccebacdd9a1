# A Slurm of one node in one folder, with its own keys and ports: start_slurm FOLDER, stop_slurm FOLDER.

start_slurm() {
    local folder=$1 ports
    mkdir -p "$folder"/{state,spool,munge}
    chmod 700 "$folder/munge"
    head -c 128 /dev/urandom >"$folder/munge/key"
    chmod 400 "$folder/munge/key"
    read -r -a ports < <(/usr/bin/python3 -c 'import socket
free = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(one.getsockname()[1] for one in free))')
    cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
AuthType=auth/munge
# A job that is queued again waits until its credential has expired: two minutes unless told.
AuthInfo=socket=$folder/munge/socket,cred_expire=5
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
MailProg=/bin/true
# No control groups: a container may not make them.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
KillWait=5
ReturnToService=2
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$(hostname) Default=YES MaxTime=INFINITE State=UP
END
    export SLURM_CONF=$folder/slurm.conf
    # Started as a whole or not at all: what fails says so in its log.
    munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munged.pid" \
        --log-file="$folder/munged.log" --seed-file="$folder/munge/seed" 3>&-
    # Each takes the processors that it may use, however many there are.
    slurmctld -c 3>&-
    slurmd -c 3>&-
    slurm_is_up() { [ "$(sinfo -h -o %T 2>/dev/null)" = idle ]; }
    wait_for 20 slurm_is_up || { cat "$folder"/*.log; return 1; }
}

stop_slurm() {
    local folder=$1
    SLURM_CONF=$folder/slurm.conf scancel --user="$(id -un)" 2>/dev/null || true
    for _ in $(seq 50); do
        [ -z "$(SLURM_CONF=$folder/slurm.conf squeue -h 2>/dev/null)" ] && break
        sleep 0.2
    done
    for name in slurmd slurmctld munged; do
        [ ! -e "$folder/$name.pid" ] || kill "$(cat "$folder/$name.pid")" || true
    done
    for name in slurmd slurmctld munged; do
        for _ in $(seq 50); do
            [ -e "$folder/$name.pid" ] || break
            sleep 0.1
        done
    done
}
