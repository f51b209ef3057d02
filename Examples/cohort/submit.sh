#!/usr/bin/env bash
# A BIDS dataset as a job array of Slurm, without Snakemake: a task for one or more participants,
# then the group.
#
#   submit.sh JOBS BIDS_DIR OUT_DIR [OPTION OF adaptiso-bids...]    the first time
#   submit.sh JOBS                                                  again, after an interruption
#
# JOBS is a folder that is made; it keeps what the jobs are to do as it was when they were first
# submitted (participants, options, version), so that a dataset that grows meanwhile does not shift
# the tasks, and the logs. Submitting again starts all tasks; what is finished is only looked at.
# ADAPTISO_PER_TASK participants a task (default 1): for more participants than the cluster's
# MaxArraySize. ADAPTISO_SBATCH: options for sbatch ("--partition=short --mem=4G").
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
jobs=$(realpath -m "${1:?"usage: submit.sh JOBS [BIDS_DIR OUT_DIR [OPTION...]]"}")
shift
if [ $# -gt 0 ]; then
    bids=$(realpath -e "$1") out=$(realpath -m "${2:?"OUT_DIR is missing"}")
    shift 2
    if [ -e "$jobs/participants" ]; then
        echo "submit.sh: $jobs is there already; go on with: submit.sh $jobs" >&2
        exit 2
    fi
    # a name with a line end or a blank would be taken for several, one with dashes for an option
    if odd=$(cd "$bids" && find . -maxdepth 1 -name 'sub-*' -xtype d ! -regex '\./sub-[A-Za-z0-9+]+' -print -quit) &&
        [ -n "$odd" ]; then
        printf 'submit.sh: %q in BIDS_DIR: is no name of a participant (sub- and letters and digits)\n' \
            "${odd#./}" >&2
        exit 3
    fi
    mkdir -p "$jobs/logs"
    printf '%s\n' "$bids" "$out" >"$jobs/folders"
    printf '%s\n' "$@" >"$jobs/options"
    echo "${ADAPTISO_PER_TASK:-1}" >"$jobs/perTask"
    adaptiso-bids --version >"$jobs/version"
    (cd "$bids" && find . -maxdepth 1 -name 'sub-*' -xtype d -printf '%f\n' | sort) >"$jobs/.participants"
    mv "$jobs/.participants" "$jobs/participants" # last: now all is there
fi
count=$(wc -l <"$jobs/participants") per=$(cat "$jobs/perTask")
if [ "$count" -eq 0 ]; then
    echo "submit.sh: there is no participant (sub-*)" >&2
    exit 3
fi
# shellcheck disable=SC2086 # several words
array=$(sbatch --parsable --array="1-$(((count + per - 1) / per))" --output="$jobs/logs/%a.log" \
    ${ADAPTISO_SBATCH:-} "$here/participant.sbatch" "$jobs")
# shellcheck disable=SC2086
group=$(sbatch --parsable --dependency="afterany:$array" --output="$jobs/logs/group.log" \
    ${ADAPTISO_SBATCH:-} "$here/group.sbatch" "$jobs")
echo "$array $group"
