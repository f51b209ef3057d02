#!/usr/bin/env bash
# Makes Debian packages by Packaging/debian, in FOLDER (default: build/debian).
#
#   Packaging/debian.sh source [FOLDER]            the source package of HEAD: .dsc, .orig.tar.xz, .debian.tar.xz
#   Packaging/debian.sh binary [FOLDER [BUILD]]    the packages of a build, build/release unless said otherwise
#
# The same commit gives the same source package, the same build the same packages.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=${2:-$top/build/debian}
mkdir -p "$folder"
folder=$(realpath "$folder")
version=$(sed -nE 's/^adaptiso \((.*)-[^-]*\) .*/\1/p;q' "$top/Packaging/debian/changelog")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/adaptiso-$version
umask 022

case ${1:-} in
    source)
        git -C "$top" archive --prefix="adaptiso-$version/" HEAD | xz -T1 >"$work/adaptiso_$version.orig.tar.xz"
        tar -C "$work" -xf "$work/adaptiso_$version.orig.tar.xz"
        cp -r "$tree/Packaging/debian" "$tree/debian"
        (cd "$work" && dpkg-source -b "$tree")
        ;;
    binary)
        build=$(realpath -e "${3:-$top/build/release}")
        mkdir "$tree"
        cp -r "$top/Packaging/debian" "$top/CHANGELOG.md" "$tree"
        profiles=nodoc
        if grep -q '^ADAPTISO_BUILD_SITE:BOOL=ON' "$build/CMakeCache.txt"; then profiles=; fi
        cmake --build "$build" >&2
        (cd "$tree" && DEB_BUILD_OPTIONS=noautodbgsym DEB_BUILD_PROFILES=$profiles dpkg-architecture -c \
            fakeroot debian/rules binary ADAPTISO_BUILD="$build" >&2)
        ;;
    *)
        sed -n '2,/^$/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
        exit 2
        ;;
esac
find "$work" -maxdepth 1 -type f ! -name '*.buildinfo' ! -name '*.changes' -exec mv -t "$folder" {} +
ls -1 "$folder"
