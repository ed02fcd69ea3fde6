#!/bin/bash
# The array of a campaign for LSF; see docs/CLUSTER.md. LSF itself requeues a task that ends with 75.
#
#   kirigami campaign submit CAMPAIGN --shards N --time MINUTES --template configs/cluster/lsf.sh --dry-run > campaign.lsf
#   bsub -J "NAME[1-N]" < campaign.lsf
#   bsub -w "ended(NAME)" -env "all, ROLE=collect" < campaign.lsf
#BSUB -n @cores@
#BSUB -W @minutes@
#BSUB -Q 75
#BSUB -wa TERM -wt 2
#BSUB -o "@logs@/%J-%I.log"

cd @here@ || exit
if [ "${ROLE-}" = collect ]; then
    exec @collect@
fi
exec @run@ --shard "$LSB_JOBINDEX/@shards@"
