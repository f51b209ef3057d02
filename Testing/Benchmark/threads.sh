#!/usr/bin/env bash
# Time by number of threads, and how much of a run is serial.
#
#   Testing/Benchmark/threads.sh [-r REPEATS] [-n THREADS] PROGRAM [ARGUMENT...]
#
#   Testing/Benchmark/threads.sh build/release/bin/adaptiso-mesh trunk.nii --iso 300
#
# Runs `PROGRAM ARGUMENT... -q --threads N -o FILE` with N = 1, 2, 4 ... up to THREADS (default: the machine's
# processors), each REPEATS times (1), the least of each. Prints seconds by the clock, processor time and largest memory.
# With perf (Debian's linux-perf), a run with one thread is sampled: parallelShare.py prints which part of it lay outside
# of Core's parallel loops, where, and by that how many times faster more threads would be. Processor time, so other work on
# the machine changes little.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
repeats=1 most=$(nproc)
while getopts r:n: option; do
    case $option in
    r) repeats=$OPTARG ;;
    n) most=$OPTARG ;;
    *) sed -n 's/^#   //p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
    esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || { sed -n 's/^#   //p' "${BASH_SOURCE[0]}" >&2; exit 2; }

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

echo "threads  clock s  processor s  peak MB"
for ((n = 1; n <= most; n *= 2)); do
    for ((i = 0; i < repeats; ++i)); do
        /usr/bin/time -f '%e %U %S %M' -o "$work/time" -a "$@" -q --no-warnings --threads "$n" -o "$work/mesh.ply"
    done
    awk -v n="$n" 'NR == 1 || $1 < clock { clock = $1 } NR == 1 || $2 + $3 < used { used = $2 + $3 }
        $4 > peak { peak = $4 } END { printf "%7d  %7.2f  %11.2f  %7.0f\n", n, clock, used, peak / 1000 * 1.024 }' \
        "$work/time"
    rm "$work/time"
    md5sum <"$work/mesh.ply" >>"$work/sums"
done
[ "$(sort -u "$work/sums" | wc -l)" = 1 ] || { echo "threads.sh: the mesh depends on the number of threads" >&2; exit 1; }

if ! command -v perf >/dev/null; then
    echo "no perf: serial parts not traced"
    exit
fi
perf record -q -F 99 --call-graph dwarf,16384 -o "$work/trace" -- \
    "$@" -q --no-warnings --threads 1 -o "$work/mesh.ply"
perf script -i "$work/trace" -F ip,sym --no-inline 2>/dev/null | "$here/parallelShare.py"
