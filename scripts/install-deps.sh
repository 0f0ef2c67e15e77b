#!/bin/sh
# Installs the Debian 12 packages that a task needs, and does nothing when they are there.
#
#   scripts/install-deps.sh [build] [test] [lint]      (default: build)
#
# Runs as root or through sudo, asks nothing, and needs only a POSIX shell, dpkg and apt.
# docs/dependencies.md says what each package is for.
set -eu

build_packages='g++ cmake ninja-build pkg-config
    libassimp-dev libglm-dev libtbb-dev libhwy-dev zlib1g-dev libpng-dev libopenexr-dev
    libcairo2-dev libdxflib-dev libmuparser-dev
    libboost-dev libcli11-dev libfmt-dev nlohmann-json3-dev'
test_packages='libgtest-dev libembree-dev clang libclang-rt-14-dev llvm
    ccache openimageio-tools libgdal32'
lint_packages='clang-format clang-tidy'

fail() {
    echo "install-deps: $1" >&2
    exit 1
}

wanted=
[ $# -gt 0 ] || set -- build
for group in "$@"; do
    case $group in
        build) wanted="$wanted $build_packages" ;;
        test) wanted="$wanted $test_packages" ;;
        lint) wanted="$wanted $lint_packages" ;;
        *) fail "unknown group '$group': use build, test or lint" ;;
    esac
done

command -v dpkg-query >/dev/null 2>&1 ||
    fail "no dpkg here: this script knows Debian 12; install by hand:$(echo " $wanted" | tr -s ' \n' ' ')"

# 'install ok installed' is dpkg's word for a package that is there and configured.
present=" $(dpkg-query -W -f='${db:Status-Status} ${Package}\n' 2>/dev/null |
    sed -n 's/^installed //p' | tr '\n' ' ') "
missing=
for package in $wanted; do
    case $present in
        *" $package "*) ;;
        *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

command -v apt-get >/dev/null 2>&1 || fail "no apt-get here; install by hand:$missing"
as_root=
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null 2>&1 ||
        fail "neither root nor sudo; run as root: apt-get install --no-install-recommends$missing"
    as_root=sudo
fi

log=$(mktemp "${TMPDIR:-/tmp}/sightline-deps.XXXXXX")
trap 'rm -f "$log"' EXIT
apt() {
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o Acquire::Retries=3 \
        -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$log" 2>&1
}

echo "Installing$missing"
# A source that does not answer need not matter (it may be another vendor's): the install decides.
unreachable=
if ! apt update || grep -q '^[WE]: Failed to fetch' "$log"; then
    unreachable=' (apt-get update could not fetch every list: is the network up?)'
fi
if ! apt install --no-install-recommends $missing; then
    grep '^E:' "$log" | head -n 3 >&2
    fail "apt-get install failed$unreachable; wanted:$missing"
fi
