#!/bin/sh
# A cohort by GNU parallel: run.sh STUDIES COHORT SHARDS [OPTIONS of ventricle]
#
# Each shard is a worker of its own; a shard that fails is begun once more, and goes on where it ended. With
# --sshloginfile of parallel the shards spread over machines that share the folders.
set -eu
studies=$1 cohort=$2 shards=$3
shift 3
seq "$shards" | parallel --retries 2 --halt soon,fail=100% \
  "${DYNASURF:-dynasurf} batch '$studies' --out '$cohort' --shard {}/$shards --jobs 1 --quiet --no-collect -- $*" ||
  echo "some studies failed: see $cohort/status.tsv" >&2
"${DYNASURF:-dynasurf}" collect "$cohort" --out "$cohort/tables"
