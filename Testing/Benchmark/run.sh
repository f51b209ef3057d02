#!/usr/bin/env bash
# Compares this library with vtkFlyingEdges3D on scans and writes Markdown and JSON.
# Debian 12, as root or with sudo. Give the machine nothing else to do meanwhile.
#
#   Testing/Benchmark/run.sh [-T] [-o FOLDER] [-r REPEATS] [-t THREADS] [VOLUME:ISOVALUE[@CROP]...]
#
# FOLDER: out/benchmark when not given. It gets comparison.md and a JSON file for each volume.
# CROP: i0:i1,j0:j1,k0:k1, the samples to take, of each axis the first and the last.
# -T: the thesis's tables: open border and N = 2, 4, 8 alone; FOLDER gets thesis.md, thesis.json and
# two plots as well.
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
thesis=
what=()
while getopts To:r:t: option; do
    case $option in
    T) thesis=yes what=(--borders open --block-sizes "2,4,8") ;;
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
    heads=/usr/share/mricron/templates
    if [ "$thesis" ]; then  # as large as the thesis's cortex
        for isovalue in 90 100; do
            inputs+=("$heads/ch2bet.nii.gz:$isovalue@12:168,13:201,1:156")
        done
    else
        inputs+=("$heads/ch2bet.nii.gz:100")
    fi
    inputs+=("$heads/ch2.nii.gz:100")
fi
cropForm='^(.+)@([0-9]+:[0-9]+,[0-9]+:[0-9]+,[0-9]+:[0-9]+)$'
for input in "${inputs[@]}"; do
    case $input in
    *?:?*) ;;
    *) echo "run.sh: $input: must be VOLUME:ISOVALUE[@CROP]" >&2; usage ;;
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

written=()
for input in "${inputs[@]}"; do
    crop=()
    if [[ $input =~ $cropForm ]]; then
        input=${BASH_REMATCH[1]}
        crop=(--crop "${BASH_REMATCH[2]}")
    fi
    volume=${input%:*}
    isovalue=${input##*:}
    name=$(basename "$volume")
    json=$out/${name%%.*}-$isovalue${crop:+-cropped}.json
    echo "== $name at $isovalue ${crop[*]}"
    echo >>"$out/comparison.md"
    "$top/build/benchmark/Testing/Benchmark/compareExtraction" "$volume" --iso "$isovalue" \
        --repeats "$repeats" --threads "$threads" --commit "$commit" \
        "${what[@]}" "${crop[@]}" --json "$json" | tee -a "$out/comparison.md"
    written+=("$json")
done
if [ "$thesis" ]; then "$here/thesisTables.py" -o "$out" "${written[@]}"; fi
echo "== wrote $out/comparison.md"
