#!/usr/bin/env bash
# Makes adaptiso-<version>-linux-<machine>.tar.gz of a build: the programs, the Python package and
# the libraries that both need, except the C library. It runs from any folder, without root, on
# any Linux with glibc as new as this machine's. The same build gives the same bytes.
#
#   Packaging/archive.sh [BUILD [FOLDER]]      build/release, where the archive goes: BUILD
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath -e "${1:-$top/build/release}")
folder=$(realpath -e "${2:-$build}")
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
name=adaptiso-$version-linux-$(uname -m)
moment=${SOURCE_DATE_EPOCH:-$(git -C "$top" log -1 --format=%ct)}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/$name

umask 022
for component in programs python; do
    cmake --install "$build" --component $component --strip --prefix "$tree" >/dev/null
done
mkdir -p "$tree/lib/c++"
cp "$top/LICENSE" "$tree"
if [ -d "$tree/lib/python3/dist-packages" ]; then
    mv "$tree/lib/python3/dist-packages" "$tree/python"
    rm -r "$tree/lib/python3"
fi
mapfile -t binaries < <(find "$tree/bin" "$tree/python" -type f \( -name '*.so' -o -perm /111 \) 2>/dev/null)

# The C library stays the system's: it is the kernel's and the name service's partner. The C++
# runtime is for the programs alone: a Python process already has its own.
missing=$(ldd "${binaries[@]}" | grep 'not found' || true)
if [ -n "$missing" ]; then
    echo "archive.sh: a library is missing: $missing" >&2
    exit 1
fi
ldd "${binaries[@]}" | sed -nE 's/^\t([^ ]+) => (\/[^ ]+) .*/\1 \2/p' | sort -u |
    while read -r soname path; do
        case $soname in
            libc.so.* | libm.so.* | libdl.so.* | libpthread.so.* | librt.so.* | libresolv.so.*) continue ;;
            libstdc++.so.* | libgcc_s.so.*) to=$tree/lib/c++ ;;
            *) to=$tree/lib ;;
        esac
        cp -L "$path" "$to/$soname"
        # dpkg knows some libraries by /lib, whose files are in /usr/lib
        package=$(dpkg-query -S "*$(realpath "$path" | sed 's|^/usr||')" | head -n 1 | cut -d : -f 1)
        mkdir -p "$tree/lib/licenses"
        cp -L "/usr/share/doc/$package/copyright" "$tree/lib/licenses/$package"
    done
chmod 644 "$tree"/lib/*.so* "$tree"/lib/c++/*

# DT_RPATH, not DT_RUNPATH: it also serves the libraries' own needs.
for binary in "${binaries[@]}"; do
    case $binary in
        "$tree"/bin/*) path='$ORIGIN/../lib:$ORIGIN/../lib/c++' ;;
        *) path='$ORIGIN/../../lib' ;;
    esac
    patchelf --force-rpath --set-rpath "$path" "$binary"
done

cat >"$tree/README.txt" <<END
adaptiso $version for Linux on $(uname -m), glibc $(getconf GNU_LIBC_VERSION | cut -d ' ' -f 2) or newer.
No installation: run bin/adaptiso-mesh --help, or put bin into PATH.
Python $(basename "$tree"/python/adaptiso/_adaptiso.*.so | sed -nE 's/.*cpython-(.)([0-9]+)-.*/\1.\2/p') with NumPy: add the folder python to PYTHONPATH, then import adaptiso.
Pages: share/doc/adaptiso. Licences of the libraries beside the programs: lib/licenses.
Research software, no medical device.
END

tar -C "$work" --sort=name --mtime="@$moment" --owner=0 --group=0 --numeric-owner \
    --mode=u+rwX,go+rX,go-w -cf - "$name" | gzip -6n >"$work/archive"
mv "$work/archive" "$folder/$name.tar.gz"
echo "$folder/$name.tar.gz"
