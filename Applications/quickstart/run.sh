#!/usr/bin/env bash
# From a fresh clone to a brain's surface: installs the packages, builds adaptiso-mesh, meshes a
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

echo "== building adaptiso-mesh"
# a folder that Testing/run.sh has configured stays as it is
if [ ! -e build/release/build.ninja ]; then
    cmake --log-level=WARNING --preset release -DADAPTISO_BUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON
fi
cmake --build --preset release --target adaptiso-mesh

scan=/usr/share/mricron/templates/ch2bet.nii.gz # T1 MRI of one head, skull removed
mkdir -p "$out"
echo "== meshing and drawing $scan"
build/release/bin/adaptiso-mesh "$scan" --iso auto --largest --fill-cavities -o "$out/brain.vtp" \
    --pictures "$out/pictures" --picture-view 105,18

cat <<END

mesh:     $out/brain.vtp
picture:  $out/pictures/view-1.png
program:  $top/build/release/bin/adaptiso-mesh --help
the rest: cmake --build --preset release --target programs
END
