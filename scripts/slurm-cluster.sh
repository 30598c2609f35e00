# SPDX-License-Identifier: BSD-3-Clause
# A Slurm cluster of this machine alone, for the trials that source this file; as root. It lies in the folder $work,
# which goes with it when the trial ends.

trial=$(basename "$0")
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d "/tmp/slipfront-slurm.XXXXXX")
port=$((20000 + RANDOM % 20000))
pids=()
trap end_cluster EXIT

export SLURM_CONF=$work/slurm.conf

# Jobs first: what runs them does not end with the daemons.
end_cluster() {
  if [ -f "$SLURM_CONF" ]; then
    scancel --partition=trial 2>/dev/null || true
    for _ in $(seq 60); do
      [ -n "$(squeue -h 2>/dev/null)" ] || break
      sleep 0.5
    done
  fi
  [ ${#pids[@]} -eq 0 ] || kill "${pids[@]}" 2>/dev/null || true
  wait
  rm -rf "$work"
}

start_cluster() {
  mkdir "$work"/{state,spool,munge}
  chmod 755 "$work"
  dd if=/dev/urandom of="$work/munge/key" bs=128 count=1 status=none
  chmod 600 "$work/munge/key"
  cat > "$SLURM_CONF" <<CONF
ClusterName=trial
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
KillWait=5
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=4000 State=UNKNOWN
PartitionName=trial Nodes=ALL Default=YES State=UP
CONF
  munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" 2> "$work/munged.err" &
  pids+=($!)
  until [ -S "$work/munge/socket" ]; do sleep 0.1; done
  slurmctld -D -f "$SLURM_CONF" 2> "$work/slurmctld.log" &
  pids+=($!)
  slurmd -D -f "$SLURM_CONF" 2> "$work/slurmd.log" &
  pids+=($!)
  for _ in $(seq 60); do
    sinfo -h -o %T 2>/dev/null | grep -q idle && return
    sleep 0.5
  done
  echo "$trial: the cluster does not start" >&2
  tail "$work"/*.log "$work/munged.err" >&2
  exit 1
}

wait_for_jobs() {
  while [ -n "$(squeue -h)" ]; do sleep 0.5; done
}
