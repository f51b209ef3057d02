#!/usr/bin/env bash
# Installs what it needs and builds the page, build/web/adaptiso.html, one file, and the npm package,
# build/web/npm/adaptiso-VERSION.tgz. Debian 12, as root or with sudo, and Node 20 or later with npm.
# Running it again is harmless.
#
#   Applications/web/run.sh [--quick]           both; --quick: made in less time, larger and slower
#   Applications/web/run.sh [--quick] --test    and tests them beside the native programs in ADAPTISO_BIN, or
#                                               build/release/bin: the modules' unit tests, the programs and
#                                               the package under Node, the page in Chromium and Firefox;
#                                               --quick: without the unit tests of Extraction, Mending,
#                                               Labels, HeadModel and MeshQuality, which take minutes and whose
#                                               results are in the programs' bytes; the longest tests of the
#                                               page in Chromium alone. Ends with ctest's summary and its
#                                               exit code
set -euo pipefail

optimisation=-O3
unitTests=(unitTests)
without=()
isTest=
for option; do
    case $option in
        --quick)
            optimisation=-O1
            export ADAPTISO_WEB_QUICK=1
            unitTests=(testCore testImageIO testMeshIO testSpanSpace)
            without=(-E '^(Extraction|Mending|AdaptiveClasses|Labels|HeadModel|MeshQuality)$')
            ;;
        --test) isTest=yes ;;
        *) echo "Applications/web/run.sh: unknown option $option; --quick and --test are known" >&2; exit 2 ;;
    esac
done
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$top"

. Applications/quickstart/packages.sh
installPackages Applications/web/packages.txt

node=$(node --version 2>/dev/null || echo v0)
if [[ ${node#v} != 2[0-9]* && ${node#v} != [3-9][0-9]* ]] || ! command -v npm >/dev/null; then
    echo "Applications/web/run.sh: needs Node 20 or later with npm, found ${node} (https://nodejs.org)" >&2
    exit 1
fi
export ADAPTISO_SOURCE=$top ADAPTISO_BIN=${ADAPTISO_BIN:-$top/build/release/bin}
if [[ $isTest && ! -x $ADAPTISO_BIN/adaptiso-mesh ]]; then
    echo "Applications/web/run.sh: the tests compare with the native programs, which $ADAPTISO_BIN lacks: cmake --preset release && cmake --build --preset release --target programs" >&2
    exit 1
fi

export NODE_PATH=/usr/share/nodejs  # acorn, which Emscripten's linker needs, for a Node that is not Debian's
cmake --log-level=WARNING --preset web -DADAPTISO_WEB_LINK=$optimisation -DCMAKE_CXX_FLAGS_RELEASE="$optimisation -DNDEBUG" -DCMAKE_UNITY_BUILD=ON
cmake --build --preset web --target adaptisoWeb adaptisoNode ${isTest:+"${unitTests[@]}"}
version=$(sed -n 's/^project(adaptiso VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
node Applications/web/npm/build.mjs build/web "$version"
cd Applications/web/page
npm ci --ignore-scripts --no-audit --no-fund --silent
npm run --silent check
node build.mjs "$top/build/web" "$version"
if [[ $isTest ]]; then
    cd "$top"
    exec ctest --preset web -j "$(nproc)" "${without[@]}"
fi
