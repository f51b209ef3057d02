#!/usr/bin/env bash
# The surface of one large volume as job arrays of Slurm, without Snakemake.
#
#   submit.sh WORK OUT --input IMAGE --iso VALUE [OPTION OF adaptiso-giant plan...]
#
# Plans here, then submits an array for the tiles, one for the seam boxes (method adaptive), and the
# join. Submitting again with the same words starts all tasks; what is finished is only looked at.
# ADAPTISO_PER_TASK pieces a task (default 8). ADAPTISO_SBATCH: options for sbatch.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(realpath -m "${1:?"usage: submit.sh WORK OUT --input IMAGE --iso VALUE [OPTION...]"}")
out=$(realpath -m "${2:?"OUT is missing"}")
shift 2
per=${ADAPTISO_PER_TASK:-8}
adaptiso-giant plan "$work" "$@"
for place in "$work/logs" "$work"/{tile,seam}.ids; do
    if [ -L "$place" ]; then
        echo "submit.sh: $place: is a link; remove it" >&2
        exit 3
    fi
done
mkdir -p "$work/logs"
after=""
for stage in tile seam; do
    python3 -c "import json, sys; print(*json.load(open(sys.argv[1]))[sys.argv[2] + 's'], sep='\n')" \
        "$work/plan.json" "$stage" | sed '/^$/d' >"$work/$stage.ids"
    count=$(wc -l <"$work/$stage.ids")
    [ "$count" -eq 0 ] && continue
    # shellcheck disable=SC2086 # several words
    job=$(sbatch --parsable --array="1-$(((count + per - 1) / per))" $after \
        --output="$work/logs/$stage-%a.log" ${ADAPTISO_SBATCH:-} "$here/pieces.sbatch" "$work" "$stage" "$per")
    after="--dependency=afterok:$job --kill-on-invalid-dep=yes"
    echo "$stage $job"
done
# shellcheck disable=SC2086
job=$(sbatch --parsable $after --output="$work/logs/join.log" ${ADAPTISO_SBATCH:-} "$here/join.sbatch" \
    "$work" "$out")
echo "join $job"
