#!/usr/bin/env bash
# Builds the fuzzers and runs each of them from the seeds that makeSeeds makes, the given cases
# where they are there, and what earlier runs kept. Prints a table; fails when one crashes, hangs,
# leaks or takes too much memory, and keeps the input in build/fuzz/found.
# Debian 12, as root or with sudo.
#
#   Testing/Fuzz/run.sh [SECONDS] [TARGET...]     600 s each unless said otherwise; e.g. 60 ply dicom
#
#   JOBS=2           fuzzers at a time
#   CASES=<folder>   images-*.tar.gz to begin with as well; ../shared/data unless said otherwise
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$top"
seconds=${1:-600}
shift || true
jobs=${JOBS:-2}
cases=${CASES:-$top/../shared/data}

. Applications/quickstart/packages.sh
installPackages Applications/quickstart/packages.txt Testing/packages.txt Testing/Fuzz/packages.txt

cmake --log-level=WARNING --preset fuzz -DCMAKE_UNITY_BUILD=ON
cmake --build --preset fuzz
programs=$top/build/fuzz/Testing/Fuzz
found=$top/build/fuzz/found
work=$(mktemp -d -p "$([ -w /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")" fuzz-XXXXXX)
trap 'rm -rf "$work"' EXIT
mkdir -p "$found" "$work/files"
"$programs/makeSeeds" "$work/seeds"

targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
    for program in "$programs"/fuzz-*; do targets+=("${program##*/fuzz-}"); done
fi

# Small files alone: a long one is fuzzed slowly, and its header is what counts.
takeCases() {
    local archive=$1 folder file slices number=0
    mkdir "$work/cases"
    tar -xzf "$archive" -C "$work/cases"
    while IFS= read -r -d '' file; do
        case "$file" in
            *.nii | *.nii.gz | *.hdr) folder=nii ;;
            *.mgh | *.mgz) folder=mgh ;;
            *.nrrd | *.nhdr) folder=nrrd ;;
            *.mha | *.mhd) folder=mha ;;
            *) continue ;;
        esac
        number=$((number + 1))
        cp "$file" "$work/seeds/$folder/case-${archive##*/}-$number"
    done < <(find "$work/cases" -type f -size -17k -print0)
    while IFS= read -r -d '' folder; do  # FuzzDicom.cxx takes them one after the other
        mapfile -d '' slices < <(find "$folder" -maxdepth 1 -type f -name '*.dcm' -print0 | sort -z)
        number=$((number + 1))
        cat "${slices[@]:0:3}" > "$work/seeds/dicom/case-${archive##*/}-$number"
    done < <(find "$work/cases" -type f -name '*.dcm' -size -17k -printf '%h\0' | sort -zu)
    rm -r "$work/cases"
}
for archive in "$cases"/images-*.tar.gz; do
    if [ -r "$archive" ]; then takeCases "$archive"; fi
done

# fuzz TARGET: a row of the table in $work/TARGET.row, the log in build/fuzz/found/TARGET.log
fuzz() {
    local target=$1 log=$found/$1.log corpus=$top/build/fuzz/corpus/$1 verdict=sound
    local dictionary=$top/Testing/Fuzz/dictionaries/$target.txt
    mkdir -p "$corpus"
    mkdir "$work/files/$target"
    local options=(-max_total_time="$seconds" -timeout=5 -rss_limit_mb=2048 -max_len=65536
        -print_final_stats=1 -artifact_prefix="$found/$target-")
    if [ -e "$dictionary" ]; then options+=(-dict="$dictionary"); fi
    TMPDIR=$work/files/$target ASAN_OPTIONS=allocator_may_return_null=1 \
        UBSAN_OPTIONS=print_stacktrace=1 nice "$programs/fuzz-$target" "${options[@]}" \
        "$corpus" "$work/seeds/$target" > "$log" 2>&1 || verdict=FOUND
    # #N ... cov: C ft: F corp: ...
    local count rate coverage
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
    coverage=$(grep -a -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d ' ' -f 2)
    printf '%-10s %12s %8s %8s  %s\n' "$target" "$count" "$rate" "$coverage" "$verdict" \
        > "$work/$target.row"
}
export -f fuzz
export top seconds programs found work

printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -euc 'fuzz {}'

printf '%-10s %12s %8s %8s\n' target executions 'per s' edges
cat "$work"/*.row
failed=0
for target in "${targets[@]}"; do
    if ! grep -q FOUND "$work/$target.row"; then continue; fi
    failed=1
    echo "$target: see $found/$target.log" >&2
    grep -a -E '^SUMMARY|Test unit written|terminate called|runtime error' "$found/$target.log" >&2 ||
        true
done
exit $failed
