#!/bin/bash
# Measures how plotting a rough height map of 4,096 x 4,096 grows with the number of curves, and
# prints the table of docs/performance.md: medians, whole process without starting it.
#
#   scripts/measure-plot.sh PROGRAM
#
# COUNTS (a list with blanks between) and ROUNDS change what is measured.
set -euo pipefail
[ $# -eq 1 ] || { echo "usage: scripts/measure-plot.sh PROGRAM" >&2; exit 2; }
program=$1
counts=${COUNTS:-100 500 1000 2000 4000}
rounds=${ROUNDS:-3}
work=$(mktemp -d "${TMPDIR:-/tmp}/sightline-plot.XXXXXX")
trap 'rm -rf "$work"' EXIT

# Eight octaves of waves across each other; the finest is three cells long.
python3 - "$work/map.npy" <<'PYTHON'
import array, math, struct, sys
side = 4096
octaves = [(170 / 1.7**k, 2 * math.pi * 2.5 * 2.6**k / side, 1.3 * k) for k in range(8)]
across = [[math.sin(f * i + p) for i in range(side)] for _, f, p in octaves]
header = "{'descr': '<f4', 'fortran_order': False, 'shape': (%d, %d), }" % (side, side)
header = header.ljust(117) + "\n"
with open(sys.argv[1], "wb") as out:
    out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
    for k in range(side):
        w = [a * math.cos(0.9 * f * k - 2 * p) for a, f, p in octaves]
        out.write(array.array("f", [sum(map(float.__mul__, w, column))
                                    for column in zip(*across)]).tobytes())
PYTHON

echo "| curves | load, ms | find what is visible, ms | write, ms | all, ms | peak, MiB |"
echo "|---|---|---|---|---|---|"
for count in $counts; do
    for _ in $(seq "$rounds"); do
        "$program" plot "$work/map.npy" --count "$count" --axes none -o "$work/plot.svg" --json
    done | sed -E 's/.*"load_ms":([0-9.]+).*"sample_ms":([0-9.]+).*"draw_ms":([0-9.]+).*"write_ms":([0-9.]+).*"peak_rss_mb":([0-9.]+).*/\1 \2 \3 \4 \5/' |
        awk '{ print $1 + $2, $3, $4, $1 + $2 + $3 + $4, $5 }' | sort -n -k4 |
        awk -v count="$count" '{ row[NR] = $0 } END {
            split(row[int((NR + 1) / 2)], m)
            printf "| %d | %.0f | %.0f | %.0f | %.0f | %.0f |\n", count, m[1], m[2], m[3], m[4], m[5] }'
done
