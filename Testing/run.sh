#!/usr/bin/env bash
# Installs the packages, builds everything and runs the tests (all but those labelled long).
# Debian 12, as root or with sudo. Running it again is harmless. Ends with ctest's own summary, and
# leaves the results in build/release/junit.xml (Documentation/Validation.md is made from them).
#
#   Testing/run.sh [CTEST-OPTION...]       e.g. Testing/run.sh -L unit, Testing/run.sh -R KdTree
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$top"

. Applications/quickstart/packages.sh
installPackages Applications/quickstart/packages.txt Packaging/packages.txt Testing/packages.txt
# ParaView's Python modules, which exclude VTK's (python3-vtk9) where they are installed; Debian 12's
# import a function that its Python no longer has
if [ ! -d build/paraview/usr ]; then
    mkdir -p build/paraview
    (cd build/paraview && apt-get download python3-paraview && dpkg-deb -x python3-paraview_*.deb .)
    sed -i 's/import getargspec/import getfullargspec as getargspec/' \
        build/paraview/usr/lib/python3/dist-packages/paraview/detail/pythonalgorithm.py
fi

cmake --log-level=WARNING --preset release
cmake --build --preset release
# one more than there are processors: some tests wait for Slurm, for browsers, for a time to pass
exec ctest --preset release --output-on-failure -LE long -j "$(($(nproc) + 1))" \
    --output-junit "$top/build/release/junit.xml" "$@"
