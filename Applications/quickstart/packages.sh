# shellcheck shell=bash
# Sourced by the scripts that need packages; defines installPackages.

# installPackages LIST...: installs what the lists name (one package a line, # begins a comment)
# and the machine lacks. Asks the network nothing when all of it is there.
installPackages() {
    local wanted installed missing asRoot=()
    mapfile -t wanted < <(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$@" | sort -u)
    mapfile -t installed < <(
        dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
            sed -n 's/^installed //p' | sort -u)
    mapfile -t missing < <(
        comm -23 <(printf '%s\n' "${wanted[@]}") <(printf '%s\n' "${installed[@]}"))
    if [ ${#missing[@]} -eq 0 ]; then
        return 0
    fi
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "cannot install without root or sudo: ${missing[*]}" >&2
            return 1
        fi
        asRoot=(sudo)
    fi
    echo "== installing: ${missing[*]}"
    "${asRoot[@]}" apt-get -q -o Acquire::Retries=3 update
    "${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Acquire::Retries=3 \
        -o Dpkg::Use-Pty=0 install --no-install-recommends "${missing[@]}" </dev/null
}
