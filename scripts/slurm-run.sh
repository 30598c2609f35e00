#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#SBATCH --job-name=slipfront
#SBATCH --ntasks=2
#SBATCH --cpus-per-task=1
#SBATCH --time=24:00:00
#SBATCH --signal=TERM@300
#SBATCH --requeue
#SBATCH --open-mode=append
# One event shared by several processes, over as many jobs as it takes:
#   sbatch slurm-run.sh CASE DIR
# 300 s before its limit the job gets a signal to stop. The run then keeps a checkpoint, ends with exit code 143, and
# the job puts itself back into the queue, to go on with it.
set -u
case=$1
dir=$2

begin=("$case" -o "$dir")
for name in unfinished publishing run.json; do
  [ -e "$dir/$name" ] && begin=(--restart "$dir")
done
cpus=${SLURM_CPUS_PER_TASK:-1} # of which srun knows nothing since Slurm 22.05
srun --mpi=pmix --kill-on-bad-exit=1 --cpus-per-task="$cpus" slipfront run "${begin[@]}" --threads "$cpus" --quiet
code=$?
[ "$code" -eq 143 ] && scontrol requeue "$SLURM_JOB_ID"
exit "$code"
