#!/bin/bash
# Proves that the two commands of the README do all set-up by themselves: makes a bare Debian 12
# tree with debootstrap that holds nothing but make and git, clones this repository's HEAD into it,
# and runs each command first thing in a fresh copy of that tree.
#
#   scripts/prove-bare.sh [COMMAND...]        (default: 'make demo' 'make test')
#
# Needs root and debootstrap, and about 4 GiB under $SIGHTLINE_BARE_DIR (default
# /var/tmp/sightline-bare), which is kept for the next run; remove it by hand. The mirror, its keys
# and the name server are those of this machine, read when the script runs.
set -euo pipefail

repository=$(cd "$(dirname "$0")/.." && pwd)
work=${SIGHTLINE_BARE_DIR:-/var/tmp/sightline-bare}
base=$work/base

fail() {
    echo "prove-bare: $1" >&2
    exit 1
}
[ "$(id -u)" -eq 0 ] || fail "chroot needs root: run it with sudo"
command -v debootstrap >/dev/null || fail "debootstrap is missing: apt-get install debootstrap"
[ $# -gt 0 ] || set -- 'make demo' 'make test'

# First mirror that serves bookworm here, from deb822 files or one-line lists.
mirror() {
    local files
    files=$(ls /etc/apt/sources.list.d/*.sources 2>/dev/null || true)
    [ -z "$files" ] || awk '
        /^URIs:/ { uri = $2 }
        /^Suites:/ && / bookworm( |$)/ { wanted = 1 }
        /^$/ { if (wanted && uri) { print uri; exit } uri = ""; wanted = 0 }
        END { if (wanted && uri) print uri }' $files | head -n 1
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
        sed -nE 's/^deb +(\[[^]]*\] +)?([^ ]+) +bookworm .*/\2/p' | head -n 1
}

make_base() {
    local from
    from=$(mirror | head -n 1)
    [ -n "$from" ] || fail "no source for bookworm in /etc/apt"
    echo "Building a bare Debian 12 tree in $base"
    rm -rf "$base.new"
    mkdir -p "$work"
    debootstrap --variant=minbase --include=make,git,ca-certificates bookworm "$base.new" "$from" \
        >"$work/debootstrap.log" 2>&1 || fail "debootstrap failed, see $work/debootstrap.log"
    # What this machine's apt needs to reach its mirror: sources, keys, proxy settings.
    rm -rf "$base.new"/etc/apt/sources.list "$base.new"/etc/apt/sources.list.d
    cp -a /etc/apt/. "$base.new/etc/apt/"
    mkdir -p "$base.new/usr/share/keyrings"
    cp -a /usr/share/keyrings/. "$base.new/usr/share/keyrings/"
    mv "$base.new" "$base"
}

# Runs a command in the repository's clone inside a fresh copy of the tree. Mounts live in a
# namespace of their own, so they go away with it whatever happens.
run_bare() {
    local command=$1 tree=$2 log=$3 begin=$SECONDS status=0
    rm -rf "$tree"
    cp -a "$base" "$tree"
    cp -L /etc/resolv.conf /etc/hosts "$tree/etc/"
    git clone -q --no-hardlinks "$repository" "$tree/root/sightline"
    echo "Running '$command' in $tree"
    begin=$SECONDS
    unshare --mount --propagation private bash -euc '
        for folder in proc sys dev; do mount --rbind /$folder "$0/$folder"; done
        exec chroot "$0" /usr/bin/env -i HOME=/root TERM=dumb LANG=C.UTF-8 \
            PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
            ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
            sh -c "cd /root/sightline && $1"' "$tree" "$command" </dev/null >"$log" 2>&1 || status=$?
    tail -n 12 "$log" | sed 's/^/    /'
    echo "'$command': exit status $status after $((SECONDS - begin)) s, log in $log"
    return "$status"
}

[ -d "$base" ] || make_base
failed=0
number=0
for command in "$@"; do
    number=$((number + 1))
    run_bare "$command" "$work/run$number" "$work/run$number.log" || failed=1
done
[ "$failed" -eq 0 ] || fail "at least one command failed"
