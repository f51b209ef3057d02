#!/usr/bin/env bash
# Builds the Debian packages twice from these sources, in folders of other names and depths, in another locale
# and time zone, and compares them to the byte. Neither build uses a compiler cache. The mask is 022 for both:
# CPack hands the packer's mask on to the package.
# Takes two builds of all programs: half an hour on two cores.
#
#   Testing/Package/reproduce.sh [FOLDER]      works in FOLDER (default: a temporary one), which is emptied
#   Testing/Package/reproduce.sh FOLDER BUILD  compares with the packages of the build folder BUILD instead
#                                              of building twice
# diffoscope, where it is installed, shows where packages differ.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:-$(mktemp -d --tmpdir adaptiso-reproduce-XXXXXX)}
other=${2:-}
export SOURCE_DATE_EPOCH=1700000000 CCACHE_DISABLE=1
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER

umask 022

rm -rf "${folder:?}/first" "$folder/second"
mkdir -p "$folder"

# packages SOURCE BUILD: configures, builds, packs
packages() {
    cmake --log-level=ERROR -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release \
        -DADAPTISO_BUILD_TESTING=OFF >/dev/null
    cmake --build "$2" -j 2 >/dev/null
    (cd "$2" && cpack -G DEB >/dev/null)
}

# copied TO: the sources as they are, without build folders
copied() {
    mkdir -p "$1"
    tar -C "$top" --exclude=./build* --exclude=./.git --exclude=./out -c . | tar -C "$1" -x
}

if [ -n "$other" ]; then
    (cd "$other" && cpack -G DEB >/dev/null)
    first=$other
else
    copied "$folder/first"
    first=$folder/first/build
    (TZ=UTC LC_ALL=C packages "$folder/first" "$first")
fi
second=$folder/second/some/where/else/o
copied "$folder/second/some/where/else"
(TZ=Pacific/Kiritimati LC_ALL=C.UTF-8 packages "$folder/second/some/where/else" "$second")

differ=0
for deb in "$first"/*.deb; do
    if cmp "$deb" "$second/$(basename "$deb")"; then
        sha256sum "$deb"
    else
        differ=1
        if command -v diffoscope >/dev/null; then
            diffoscope "$deb" "$second/$(basename "$deb")" || true
        fi
    fi
done
[ "$differ" = 0 ] && echo "the packages are the same"
exit "$differ"
