#!/usr/bin/env bash
# Compares this library with vtkFlyingEdges3D on scans and writes Markdown and JSON.
# Debian 12, as root or with sudo. Give the machine nothing else to do meanwhile.
#
#   Testing/Benchmark/run.sh [-o FOLDER] [-r REPEATS] [-t THREADS] [VOLUME:ISOVALUE...]
#
# FOLDER: out/benchmark when not given. It gets comparison.md and a JSON file for each volume.
# Without volumes: the thesis's, where they are beside the checkout, and two heads of mricron-data.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../.." && pwd)

usage() {
    sed -n 's/^#   //p' "${BASH_SOURCE[0]}" >&2
    exit 2
}

out=$top/out/benchmark
repeats=5
threads=2
while getopts o:r:t: option; do
    case $option in
    o) out=$OPTARG ;;
    r) repeats=$OPTARG ;;
    t) threads=$OPTARG ;;
    *) usage ;;
    esac
done
shift $((OPTIND - 1))

inputs=("$@")
if [ ${#inputs[@]} -eq 0 ]; then
    for name in engine teapot; do
        file=$top/../shared/data/$name.nii.gz
        if [ -e "$file" ]; then inputs+=("$file:50"); fi
    done
    inputs+=(/usr/share/mricron/templates/ch2bet.nii.gz:100
             /usr/share/mricron/templates/ch2.nii.gz:100)
fi
for input in "${inputs[@]}"; do
    case $input in
    *?:?*) ;;
    *) echo "run.sh: $input: must be VOLUME:ISOVALUE" >&2; usage ;;
    esac
done

. "$top/Applications/quickstart/packages.sh"
installPackages "$top"/Applications/quickstart/packages.txt "$top"/Testing/packages.txt \
    "$here"/packages.txt

mkdir -p "$out"
out=$(cd "$out" && pwd)
launchedFrom=$PWD
cd "$top"
cmake --log-level=WARNING --preset benchmark
cmake --build --preset benchmark --target compareExtraction benchmarkExtraction
cd "$launchedFrom"

commit=$(git -C "$top" describe --always --dirty 2>/dev/null || echo unknown)
{
    echo "# Extraction compared"
    echo
    echo "Commit $commit, $(date -u +%F), $(nproc) x $(sed -n 's/^model name.*: //p' /proc/cpuinfo |
        head -n 1). Columns: Testing/Benchmark/README.md."
} >"$out/comparison.md"

for input in "${inputs[@]}"; do
    volume=${input%:*}
    isovalue=${input##*:}
    name=$(basename "$volume")
    echo "== $name at $isovalue"
    echo >>"$out/comparison.md"
    "$top/build/benchmark/Testing/Benchmark/compareExtraction" "$volume" --iso "$isovalue" \
        --repeats "$repeats" --threads "$threads" --commit "$commit" \
        --json "$out/${name%%.*}-$isovalue.json" | tee -a "$out/comparison.md"
done
echo "== wrote $out/comparison.md"
