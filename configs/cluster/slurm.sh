#!/bin/bash
# A task of the array that `scripts/slurm-campaign` hands to Slurm (docs/CLUSTER.md), and the job after it. Arguments: the
# number of tasks, and the command, to which a task adds its shard.
#SBATCH --requeue
#SBATCH --open-mode=append

shards=$1
shift
if [ -z "${SLURM_ARRAY_TASK_ID-}" ]; then
    exec "$@"
fi

# Bash handles a signal only while it waits. It passes the signal on once and then waits for the run to stop.
trap 'trap "" TERM; kill -TERM $run' TERM
"$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" &
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
