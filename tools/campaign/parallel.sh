#!/usr/bin/env bash
# Runs a campaign with GNU parallel, one shard per job, and merges the results. Run it again after an interruption: what
# is finished is not run again.
#
#   tools/campaign/parallel.sh FILE DIR [SHARDS] [parallel options]
#
# On several machines: add -S host1,host2 --workdir . and a folder DIR that all of them see. VINVERTER names the program.
# Exit codes are those of `vinverter campaign merge`: 0 all passed, 1 one failed, 2 something has no result.
set -uo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,8p' "$0" >&2
  exit 2
fi
file=$1 out=$2 shards=${3:-$(nproc)}
shift $(($# < 3 ? $# : 3))
vinverter=${VINVERTER:-vinverter}

# {#} is parallel's number of the job, from 1.
seq "$shards" | parallel --will-cite -q --line-buffer "$@" \
  "$vinverter" campaign run "$file" --shard "{#}/$shards" --out "$out" --jobs 1 >&2
exec "$vinverter" campaign merge "$file" --out "$out"
