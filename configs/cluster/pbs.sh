#!/bin/bash
# The array of a campaign for PBS; see docs/CLUSTER.md. PBS requeues only for its operators: a task that was stopped is
# submitted again, by the same command.
#
#   kirigami campaign submit CAMPAIGN --shards N --time MINUTES --template configs/cluster/pbs.sh --dry-run > campaign.pbs
#   qsub -J 1-N campaign.pbs
#   qsub -W depend=afterany:ARRAY -v ROLE=collect campaign.pbs
#PBS -N @name@
#PBS -l select=1:ncpus=@cores@
#PBS -l walltime=@hms@
#PBS -j oe
#PBS -V

cd @here@ || exit
if [ "${ROLE-}" = collect ]; then
    exec @collect@
fi
exec @run@ --shard "$PBS_ARRAY_INDEX/@shards@"
