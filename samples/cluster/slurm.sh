#!/bin/bash
# Eight shares of one job as a Slurm array, and their reports put together at the end:
#
#   array=$(sbatch --parsable slurm.sh job.toml)
#   sbatch --dependency=afterany:$array --wrap 'resurf report merge shares/*.json -o report.json --html report.html'
#
#SBATCH --job-name=resurf
#SBATCH --array=0-7
#SBATCH --cpus-per-task=4
#SBATCH --mem=16G
#SBATCH --time=02:00:00
#SBATCH --requeue

job=${1:?the job file}
mkdir -p shares
resurf run "$job" --shard auto/8 --jobs "${SLURM_CPUS_PER_TASK:-1}" --memory 14GB \
    --report "shares/$SLURM_ARRAY_TASK_ID.json"
code=$?
case $code in
    # I/O or an interruption: what is done stays done, so going on costs nothing. Three times at most.
    7 | 130) [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ] && scontrol requeue "$SLURM_JOB_ID" ;;
esac
exit $code
