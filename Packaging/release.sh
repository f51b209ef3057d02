#!/usr/bin/env bash
# Makes all of a release from a clean clone of HEAD: the Debian source package and packages, the archive, the page,
# the npm package, the bill of materials and SHA256SUMS. Takes half an hour on two cores; no compiler cache is used.
#
#   Packaging/release.sh FOLDER            into FOLDER, which is made anew
#   Packaging/release.sh --twice FOLDER    again into FOLDER.again, from a clone of another name and depth, in another
#                                          locale and time zone; fails where a byte differs
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
isTwice=
if [ "${1:-}" = --twice ]; then
    isTwice=yes
    shift
fi
folder=$(realpath -m "${1:?release.sh: name a folder}")
export CCACHE_DISABLE=1
SOURCE_DATE_EPOCH=$(git -C "$top" log -1 --format=%ct)
export SOURCE_DATE_EPOCH
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER

. "$top/Applications/quickstart/packages.sh"
installPackages "$top/Applications/quickstart/packages.txt" "$top/Packaging/packages.txt" \
    "$top/Documentation/site/packages.txt" "$top/Applications/web/packages.txt"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# release CLONE TO
release() {
    git clone -q --no-local "$top" "$1"
    if [ -n "$(ls -A "$2" 2>/dev/null)" ] && [ ! -e "$2/SHA256SUMS" ]; then
        echo "release.sh: $2 holds other files; name an empty folder, or that of a release" >&2
        exit 1
    fi
    rm -rf "$2"
    mkdir -p "$2"
    cmake --log-level=ERROR -S "$1" -B "$1/build/release" -G Ninja -DCMAKE_BUILD_TYPE=Release \
        -DADAPTISO_BUILD_TESTING=OFF -DADAPTISO_BUILD_PYTHON=ON -DADAPTISO_BUILD_SITE=ON
    if ! compgen -G "$1/build/release/Modules/Report/niivue/package/dist/*" >/dev/null; then
        echo "release.sh: npm's registry is not reached: reports would have no viewer (niivue)" >&2
        exit 1
    fi
    cmake --build "$1/build/release"
    "$1/Packaging/debian.sh" source "$2"
    "$1/Packaging/debian.sh" binary "$2" "$1/build/release"
    "$1/Packaging/archive.sh" "$1/build/release" "$2"
    cp "$1/build/release/Packaging/adaptiso.spdx.json" "$1/Packaging/Containerfile" "$2"
    "$1/Applications/web/run.sh"
    cp "$1"/build/web/adaptiso.html "$1"/build/web/npm/adaptiso-*.tgz "$2"
    (cd "$2" && sha256sum -- * >SHA256SUMS)
}

(TZ=UTC LC_ALL=C release "$work/first" "$folder")
if [ -n "$isTwice" ]; then
    (TZ=Pacific/Kiritimati LC_ALL=C.UTF-8 release "$work/second/some/where/else" "$folder.again")
    diff "$folder/SHA256SUMS" "$folder.again/SHA256SUMS"
fi
cat "$folder/SHA256SUMS"
