#!/usr/bin/env bash
# From a fresh clone to a brain's surface: installs the packages, builds the programs, meshes a
# real MRI scan and draws the mesh. Debian 12, as root or with sudo. Running it again is harmless.
#
#   Applications/quickstart/run.sh [OUTPUT-FOLDER]      (out/quickstart when none is given)
set -euo pipefail

if [ $# -gt 1 ] || [[ ${1:-} == -* ]]; then
    echo "usage: $0 [OUTPUT-FOLDER]" >&2
    exit 2
fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../.." && pwd)
out=$(realpath -m "${1:-$top/out/quickstart}")
cd "$top"

# shellcheck source=packages.sh
. "$here/packages.sh"
installPackages "$here/packages.txt"

echo "== building"
cmake --log-level=WARNING --preset programs
cmake --build --preset programs

scan=/usr/share/mricron/templates/ch2bet.nii.gz # T1 MRI of one head, skull removed
isovalue=100                                    # near the border of the white matter
mkdir -p "$out"
echo "== meshing $scan at $isovalue"
build/programs/bin/adaptiso-mesh "$scan" --iso "$isovalue" -o "$out/brain.vtp" \
    --json "$out/brain.json"

echo "== drawing"
counts=$(/usr/bin/python3 "$here/counts.py" "$out/brain.json")
LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a /usr/bin/python3 "$here/picture.py" \
    "$out/brain.vtp" "$out/brain.png" "$counts"

echo
echo "mesh:    $out/brain.vtp"
echo "         $counts"
echo "report:  $out/brain.json"
echo "picture: $out/brain.png"
