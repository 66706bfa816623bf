#!/usr/bin/env bash
# Runs a campaign as a Slurm job array, one shard per task. Submit it with the range that you want:
#
#   job=$(sbatch --parsable --array=1-64 tools/campaign/slurm.sh FILE DIR)
#   sbatch --dependency=afterany:"$job" --wrap "vinverter campaign merge FILE --out DIR"
#
# DIR is a folder that all nodes see. Submit it again after a time limit or a lost node: what is finished is not run
# again. VINVERTER names the program.
#SBATCH --job-name=vinverter-campaign
#SBATCH --cpus-per-task=2
#SBATCH --mem-per-cpu=1G
#SBATCH --time=04:00:00
#SBATCH --requeue
set -euo pipefail
if [ $# -ne 2 ] || [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then
  sed -n '2,9p' "$0" >&2
  exit 2
fi
# Counted from 1 whatever the array begins with.
shard=$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN + 1))
# A failed case is a result, not a failed task: only cases without result count.
"${VINVERTER:-vinverter}" campaign run "$1" --shard "$shard/$SLURM_ARRAY_TASK_COUNT" --out "$2" \
  --jobs "${SLURM_CPUS_PER_TASK:-1}" || true
exec "${VINVERTER:-vinverter}" campaign missing "$1" --shard "$shard/$SLURM_ARRAY_TASK_COUNT" --out "$2"
