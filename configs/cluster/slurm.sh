#!/bin/bash
# The array of a campaign, as `kirigami campaign submit` hands it to Slurm; see docs/CLUSTER.md. Words between two @ are
# replaced. A copy with a site's own header (account, modules) is named by --template. Submitted with the argument
# `collect`, the same script collects the database after the array.
#SBATCH --job-name=@name@
#SBATCH --cpus-per-task=@cores@
#SBATCH --time=@minutes@
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output="@logs@/%x-%A-%a.log"
# This script receives SIGTERM before the time limit.
#SBATCH --signal=B:TERM@@grace@

cd @here@ || exit
if [ "${1-}" = collect ]; then
    exec @collect@
fi

# Bash handles a signal only while it waits. It passes the signal on once and then waits for the run to stop.
trap 'trap "" TERM; kill -TERM $run' TERM
@run@ --shard "$SLURM_ARRAY_TASK_ID/@shards@" &
run=$!
wait $run
code=$?
if [ $code -gt 128 ]; then
    wait $run
    code=$?
fi

# 75: stopped before its work was done. The last task of an array has the array's own SLURM_JOB_ID, which stands for all
# tasks: a task is named by both numbers. A task that was cancelled is not running any more and stays cancelled.
task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
state=$(squeue --noheader --format=%T --jobs="$task")
if [ $code -eq 75 ] && [ "$state" = RUNNING ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 20 ]; then
    scontrol requeue "$task"
fi
exit $code
