#!/usr/bin/env bash
# Installs what it needs and builds the page, build/web/adaptiso.html, one file, and the npm package,
# build/web/npm/adaptiso-VERSION.tgz. Debian 12, as root or with sudo, and Node 20 or later with npm.
# Running it again is harmless.
#
#   Applications/web/run.sh            both
#   Applications/web/run.sh --test     and tries them: the programs and the package under Node, the page in
#                                      Chromium and Firefox
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$top"

. Applications/quickstart/packages.sh
installPackages Applications/web/packages.txt

node=$(node --version 2>/dev/null || echo v0)
if [[ ${node#v} != 2[0-9]* && ${node#v} != [3-9][0-9]* ]] || ! command -v npm >/dev/null; then
    echo "Applications/web/run.sh: needs Node 20 or later with npm, found ${node} (https://nodejs.org)" >&2
    exit 1
fi

export NODE_PATH=/usr/share/nodejs  # acorn, which Emscripten's linker needs, for a Node that is not Debian's
cmake --log-level=WARNING --preset web
cmake --build --preset web --target adaptisoWeb adaptisoNode
version=$(sed -n 's/^project(adaptiso VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
node Applications/web/npm/build.mjs build/web "$version"
cd Applications/web/page
npm ci --ignore-scripts --no-audit --no-fund --silent
npm run --silent check
node build.mjs "$top/build/web" "$version"
if [[ ${1:-} == --test ]]; then
    programs=${ADAPTISO_PROGRAMS:-$top/build/release/bin}
    if [[ ! -x $programs/adaptiso-mesh ]]; then
        echo "Applications/web/run.sh: the tests compare with the native programs, which $programs lacks: cmake --preset release && cmake --build --preset release --target programs" >&2
        exit 1
    fi
    ADAPTISO_SOURCE=$top ADAPTISO_BIN=$programs python3 -B "$top/Testing/Application/WebTest.py"
    node --test "$top"/Applications/web/npm/test/*.test.mjs
    xvfb-run --auto-servernum node --test --test-concurrency=1 test/*.test.mjs  # Firefox has WebGL on a screen alone
fi
