#!/bin/bash
# Checks that two builds of the program (such as one with vector instructions and a scalar one)
# write the same bytes, on 1, 2 and 8 threads.
#
#   scripts/same-bytes.sh PROGRAM OTHER_PROGRAM
set -euo pipefail
[ $# -eq 2 ] || { echo "usage: scripts/same-bytes.sh PROGRAM OTHER_PROGRAM" >&2; exit 2; }
programs=("$1" "$2")
samples=$(cd "$(dirname "$0")/../samples" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# sums PROGRAM THREADS MODEL OPTIONS...: hashes of all that a render writes.
sums() {
    local program=$1 threads=$2 model=$3
    shift 3
    rm -rf "$work/files" && mkdir "$work/files"
    (cd "$work/files" && "$program" render "$model" "$@" --resolution 320x240 --quiet \
        --threads "$threads" -o picture.png --depth depth.npy --ids ids.npy --normals normals.npy \
        && sha256sum ./*)
}

cases=0
# One case: the first program on one thread is what all others must equal.
check() {
    local expected got program threads
    expected=$(sums "${programs[0]}" 1 "$@")
    for program in "${programs[@]}"; do
        for threads in 1 2 8; do
            got=$(sums "$program" "$threads" "$@")
            if [ "$got" != "$expected" ]; then
                printf 'same-bytes: %s on %s threads differs: render %s\n' \
                    "$program" "$threads" "$*" >&2
                diff <(echo "$expected") <(echo "$got") >&2 || true
                exit 1
            fi
        done
    done
    cases=$((cases + 1))
}

for model in "$samples"/*.obj "$samples"/*.ply "$samples"/*.json; do
    check "$model"
    check "$model" --projection orthographic --view front --shading flat
    check "$model" --samples 4 --view trimetric --shading gouraud
done
# Every algorithm, for some have vector code of their own.
for algorithm in $("${programs[0]}" algorithms --json | grep -o '"name":"[^"]*"' | cut -d'"' -f4); do
    check "$samples/house.obj" --algorithm "$algorithm"
done
echo "same-bytes: $cases cases, each the same on 2 programs and 1, 2 and 8 threads"
