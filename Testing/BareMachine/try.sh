#!/usr/bin/env bash
# Runs the README's two commands, twice each, in a fresh clone on a minimal Debian 12 made for it,
# and prints the minutes they take and the megabytes they install; then makes the Debian package
# there, installs it on a second minimal Debian, which has no compiler, and meshes a scan with it.
# Not part of ctest: it downloads whole systems and builds everything. Needs root, debootstrap, git.
#
#   Testing/BareMachine/try.sh [COMMIT [LOG]]       HEAD, /tmp/adaptiso-bare-machine.log
#   Testing/BareMachine/try.sh --package DEB [LOG]  the package alone, which is there already
#   Testing/BareMachine/try.sh --archive TGZ [LOG]  the archive of Packaging/archive.sh: unpacked and
#                                                   used without root on Debian 12, 13 and unstable
#   Testing/BareMachine/try.sh --container TGZ [LOG]  the container of that archive, made by buildah on a
#                                                   minimal Debian in the place of a registry's
#   Testing/BareMachine/try.sh --npm TGZ [LOG]      the npm package, by Debian 12's Node 18 without root
#
# Every way ends with the bytes of ch2bet's surface at 100, which are the same by all of them.
#
# Works in a folder under /tmp and in mount and process namespaces of its own: when it ends, however
# it ends, its mounts and processes are gone. It removes the folder and leaves the log. Packages
# come from where this machine gets them (mirror and proxy are taken from apt's configuration).
set -euo pipefail

if [ "$(id -u)" -ne 0 ]; then
    echo "try.sh: must run as root (debootstrap, chroot)" >&2
    exit 2
fi
if [ "${ADAPTISO_BARE_INSIDE:-}" != yes ]; then
    self=$(realpath "${BASH_SOURCE[0]}")
    ADAPTISO_BARE_INSIDE=yes exec unshare --mount --propagation private --pid --fork \
        --kill-child "$self" "$@"
fi

repository=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
what=${1:-}
given=
case $what in
    --package | --archive | --container | --npm)
        given=$(realpath -e "${2:?"$what needs a file"}")
        shift 2
        set -- HEAD "$@"
        ;;
esac
deb=$given
commit=$(git -C "$repository" rev-parse --verify "${1:-HEAD}^{commit}")
log=$(realpath "${2:-/tmp/adaptiso-bare-machine.log}")
work=$(mktemp -d /tmp/adaptiso-bare.XXXXXX)
root=$work/root
clone=/home/adaptiso
inside=$clone
user=  # whom runInside's commands run as; root if empty

removeAll() {
    local status=$?
    if [ "$status" -ne 0 ] && [ -e "$log" ]; then
        tail -n 30 "$log" >&2
        echo "try.sh: failed; the whole log is $log" >&2
    fi
    for mounted in "$work"/*/proc "$work"/*/dev/shm "$work"/*/dev/pts; do
        if mountpoint -q "$mounted"; then
            umount "$mounted"
        fi
    done
    rm -rf --one-file-system "$work"
}
trap removeAll EXIT
trap 'exit 130' INT TERM

# The first Debian mirror that apt on this machine uses.
aptMirror() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources \
        2>/dev/null | sed -nE 's/^(URIs:|deb( +\[[^]]*\])?) +([^ ]+\/debian\/?)( .*)?$/\3/p' | head -n 1
}

# makeRoot [RELEASE]: the minimal Debian in $root, bookworm unless said otherwise.
makeRoot() {
    local release=${1:-bookworm} sources
    debootstrap --variant=minbase "$release" "$root" "$(aptMirror)"
    for sources in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
        if [ "$release" = bookworm ] && [ -e "$sources" ]; then
            rm -f "$root/etc/apt/sources.list"
            cp "$sources" "$root$sources"
        fi
    done
    apt-config dump | grep -iE '^Acquire::(http|https)::.*Proxy' \
        >"$root/etc/apt/apt.conf.d/90proxy" || true
    cp /etc/resolv.conf /etc/hosts "$root/etc/"
    mount -t proc proc "$root/proc"
    mkdir -p "$root/dev/shm" "$root/dev/pts"
    mount -t tmpfs tmpfs "$root/dev/shm"
    # pseudo-terminals, which every running system has: a test of the programs opens one
    mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
    ln -sf pts/ptmx "$root/dev/ptmx"
}

# Megabytes of the system in $root, without the clone and apt's downloads.
systemMegabytes() {
    du -smx --exclude="$root$clone" --exclude="$root/var/cache/apt" \
        --exclude="$root/var/lib/apt/lists" "$root" | cut -f 1
}

# runInside NAME COMMAND: runs it in the folder $inside of $root, times it, adds a line to the summary.
runInside() {
    local before after began seconds load
    before=$(systemMegabytes)
    load=$(cut -d ' ' -f 1 /proc/loadavg)
    began=$SECONDS
    echo "######## $1: $2"
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
        chroot ${user:+--userspec="$user"} "$root" bash -c "cd $inside && { $2
}" </dev/null
    seconds=$((SECONDS - began))
    after=$(systemMegabytes)
    printf '%-24s %3d min %02d s   %5d MB installed   load %s before\n' "$1" $((seconds / 60)) $((seconds % 60)) \
        $((after - before)) "$load" >>"$work/summary"
}

requireFile() {
    if [ ! -s "$root$clone/$1" ]; then
        echo "try.sh: $1 is missing or empty" >&2
        return 1
    fi
}

# recordBytes FILE: ch2bet's surface at 100, in STL
recordBytes() {
    sha256sum <"$1" | sed 's/ .*/  ch2bet at 100/' >>"$work/summary"
}

# The package $deb on a Debian of its own, that which has the package's GDCM: installed by apt with what
# it depends on, and no more, then used as a user does, on a scan that is brought along.
tryPackage() {
    local scan=/usr/share/mricron/templates/ch2bet.nii.gz
    local scanFrom=$root$scan
    [ -e "$scanFrom" ] || scanFrom=$scan
    root=$work/machine
    inside=/root
    case $(dpkg-deb -f "$deb" Depends) in
        *libgdcm3.0t64*) makeRoot trixie ;;
        *libgdcm3.0*) makeRoot bookworm ;;
        *)
            echo "try.sh: $deb is for neither Debian 12 nor 13" >&2
            return 1
            ;;
    esac
    cp "$deb" "$root/adaptiso.deb"
    cp "$scanFrom" "$root/root/"
    printf 'package %s, %s MB before\n' "$(basename "$deb")" "$(systemMegabytes)" >>"$work/summary"
    runInside "package: downloads" "apt-get -q update &&
        apt-get -q -y install --no-install-recommends --download-only /adaptiso.deb"
    # as the container's recipe does it
    runInside "package: install" \
        "$(sed -n '/^%post/,/^%environment/{/^%/!p}' "$repository/Examples/cohort/adaptiso.def")"
    runInside "package: adaptiso-mesh" \
        "adaptiso-mesh ch2bet.nii.gz --iso 100 -o brain.stl && adaptiso-check --profile view brain.stl"
    recordBytes "$root/root/brain.stl"
    inside=/ runInside "package: the others" \
        "adaptiso-bem --version && adaptiso-bids -v && adaptiso-compare /root/brain.stl /root/brain.stl &&
        adaptiso-simplify /root/brain.stl --max-error 0.5 -o /root/small.stl"
    if chroot "$root" sh -c 'command -v gcc g++ cmake'; then
        echo "try.sh: the machine for the package is not bare" >&2
        return 1
    fi
}

# The archive $given on minimal Debians, as a user without rights, who has no other library.
tryArchive() {
    local scans=/usr/share/mricron/templates release
    for release in bookworm trixie sid; do
        root=$work/$release
        inside=/home/person
        makeRoot "$release"
        mkdir -p "$root$inside"
        cp "$scans/ch2.nii.gz" "$scans/ch2bet.nii.gz" "$scans/aal.nii.gz" "$root$inside/"
        chown -R 1000:1000 "$root$inside"
        cp "$given" "$root/tmp/archive.tar.gz"
        cp "$repository/Packaging/debian/tests/session" "$root/tmp/"
        user=1000:1000
        runInside "$release: first surface" "tar -xzf /tmp/archive.tar.gz --strip-components=1 &&
            bin/adaptiso-mesh ch2bet.nii.gz --iso 100 -o brain.stl --pictures pictures"
        recordBytes "$root$inside/brain.stl"
        runInside "$release: self test" "bin/adaptiso-check --self-test"
        runInside "$release: session" "PATH=\$PWD/bin:\$PATH sh /tmp/session ."
        user=
        if [ "$release" = bookworm ]; then  # for whose Python the package is
            runInside "$release: Python" "apt-get update && apt-get install -y python3-numpy &&
                PYTHONPATH=python python3 -c 'import adaptiso; print(adaptiso.__version__)'"
        fi
    done
}

# The container of the archive $given, from a minimal Debian, as its user, who has no rights.
tryContainer() {
    local container scans=/usr/share/mricron/templates
    buildah() { command buildah --storage-driver vfs --root "$work/storage" --runroot "$work/run" "$@"; }
    makeRoot
    mkdir "$work/context" "$work/data"
    cp "$given" "$work/context/"
    cp "$scans/ch2bet.nii.gz" "$work/data/"
    chown -R 1000:1000 "$work/data"
    container=$(buildah from scratch)
    tar -C "$root" --one-file-system -cf "$work/base.tar" .
    buildah add -q "$container" "$work/base.tar" /
    buildah commit -q "$container" localhost/debian:12-slim
    buildah bud --isolation chroot --build-arg BASE=localhost/debian:12-slim -t adaptiso \
        -f "$repository/Packaging/Containerfile" "$work/context"
    container=$(buildah from adaptiso)
    buildah inspect --format '{{.OCIv1.Config.Entrypoint}} {{.OCIv1.Config.User}}' "$container" | grep -x '\[adaptiso\] adaptiso'
    local began=$SECONDS
    buildah run --isolation chroot -v "$work/data:/data" "$container" adaptiso mesh ch2bet.nii.gz --iso 100 -o brain.stl
    printf 'container: first surface  %s s\n' $((SECONDS - began)) >>"$work/summary"
    buildah run --isolation chroot "$container" adaptiso check --self-test
    recordBytes "$work/data/brain.stl"
    buildah images >>"$work/summary"
}

# The npm package $given, by a user without rights.
tryNpm() {
    inside=/home/person
    makeRoot
    mkdir -p "$root$inside"
    cp /usr/share/mricron/templates/ch2bet.nii.gz "$root$inside/"
    cp "$given" "$root$inside/adaptiso.tgz"
    chown -R 1000:1000 "$root$inside"
    runInside "npm: Node" "apt-get update && apt-get install -y --no-install-recommends nodejs npm && node --version"
    user=1000:1000
    runInside "npm: first surface" "export HOME=\$PWD &&
        npx --yes -p ./adaptiso.tgz adaptiso mesh ch2bet.nii.gz --iso 100 -o brain.stl"
    recordBytes "$root$inside/brain.stl"
    user=
}

# Makes the package of the clone's programs; its name is then in $deb.
makePackage() {
    runInside "package: make" ". Applications/quickstart/packages.sh &&
        installPackages Packaging/packages.txt && Packaging/debian.sh binary"
    deb=$(find "$root$clone/build/debian" -name 'adaptiso_*.deb')
}

tryAll() {
    makeRoot
    git clone -q --no-local "$repository" "$root$clone"
    git -C "$root$clone" -c advice.detachedHead=false checkout -q "$commit"
    printf 'commit %s on Debian %s, %s cores, %s MB before\n' "$commit" \
        "$(cat "$root/etc/debian_version")" "$(nproc)" "$(systemMegabytes)" >"$work/summary"

    runInside "quickstart" Applications/quickstart/run.sh
    requireFile out/quickstart/brain.vtp
    requireFile out/quickstart/pictures/view-1.png
    runInside "quickstart, again" Applications/quickstart/run.sh
    runInside "quickstart: a surface" \
        "build/release/bin/adaptiso-mesh /usr/share/mricron/templates/ch2bet.nii.gz --iso 100 -o out/brain.stl"
    recordBytes "$root$clone/out/brain.stl"
    runInside "tests" Testing/run.sh
    runInside "tests, again" Testing/run.sh
    printf 'clone with its build folders: %s MB\n' "$(du -sm "$root$clone" | cut -f 1)" \
        >>"$work/summary"
    makePackage
    tryPackage
    cat "$work/summary"
}

echo "try.sh: writing $log"
case $what in
    --package) tryPackage >"$log" 2>&1 ;;
    --archive) tryArchive >"$log" 2>&1 ;;
    --container) tryContainer >"$log" 2>&1 ;;
    --npm) tryNpm >"$log" 2>&1 ;;
    *) tryAll >"$log" 2>&1 ;;
esac
cat "$work/summary"
