#!/bin/bash
# Times our drawings beside Blender's Line Art, in turn and on the same meshes: medians of whole
# rounds, and ratios. Both look along -z at a mesh of half diagonal 1, 450 pixels a unit.
#
#   scripts/compare-line-art.sh MESHES PEER_SCRIPT [ROUNDS]
#
# MESHES has NAME.obj files in view space; PEER_SCRIPT is run by Blender with a mesh, an SVG and
# `--engine lineart --mode feature|wire`, and prints "evaluate SECONDS s" (the modifier alone,
# without loading and writing). Needs Blender and python3.
set -euo pipefail
cd "$(dirname "$0")/.."
meshes=$(realpath "${1:?usage: scripts/compare-line-art.sh MESHES PEER_SCRIPT [ROUNDS]}")
peer=$(realpath "${2:?usage: scripts/compare-line-art.sh MESHES PEER_SCRIPT [ROUNDS]}")
rounds=${3:-3}
program=$PWD/build/release/bin/sightline
work=$(mktemp -d "${TMPDIR:-/tmp}/sightline-line-art.XXXXXX")
trap 'rm -rf "$work"' EXIT
export HOME=$work

median() { sort -g | awk '{ v[NR] = $1 } END { print (NR % 2) ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }

printf '%-14s %-8s %10s %10s %10s %8s %8s\n' mesh edges 'peer ms' 'find ms' 'whole ms' 'find x' 'whole x'
for mesh in "$meshes"/*.obj; do
    name=$(basename "$mesh" .obj)
    for mode in feature wire; do
        edges=all
        [ "$mode" = feature ] || edges=mesh
        : >"$work/peer"; : >"$work/find"; : >"$work/whole"
        for _ in $(seq "$rounds"); do
            timeout 300 blender -b --factory-startup -P "$peer" -- "$mesh" "$work/p.svg" \
                --engine lineart --mode "$mode" 2>/dev/null |
                sed -n 's/.*evaluate \([0-9.]*\) s.*/\1/p' | awk '{ print 1000 * $1 }' >>"$work/peer"
            python3 - "$program" "$mesh" "$work/o.svg" "$edges" >>"$work/both" <<'PY'
import json, subprocess, sys, time
program, mesh, out, edges = sys.argv[1:]
start = time.perf_counter()
done = subprocess.run([program, 'draw', mesh, '-o', out, '--edges', edges, '--view', 'front',
                       '--projection', 'orthographic', '--ortho-height', str(1000 / 450),
                       '--resolution', '1000x1000', '--json'], capture_output=True, check=True)
print(json.loads(done.stdout)['draw_ms'], 1000 * (time.perf_counter() - start))
PY
        done
        awk '{ print $1 }' "$work/both" >"$work/find"
        awk '{ print $2 }' "$work/both" >"$work/whole"
        rm "$work/both"
        p=$(median <"$work/peer"); f=$(median <"$work/find"); w=$(median <"$work/whole")
        awk -v n="$name" -v m="$mode" -v p="$p" -v f="$f" -v w="$w" 'BEGIN {
            printf "%-14s %-8s %10.1f %10.1f %10.1f %8.1f %8.1f\n", n, m, p, f, w, p / f, p / w }'
    done
done
