#!/bin/bash
# Measures how the frame (project + resolve) grows with the triangles and with the pixels, on one
# thread and on two, and prints the two tables of docs/performance.md.
#
#   scripts/measure-growth.sh PROGRAM MODEL
#
# SIZES and RESOLUTIONS (lists with blanks between), COMPLEXITY and FRAMES change what is measured.
set -euo pipefail
[ $# -eq 2 ] || { echo "usage: scripts/measure-growth.sh PROGRAM MODEL" >&2; exit 2; }
program=$1 model=$2
sizes=${SIZES:-1000 10000 100000 1000000 10000000}
resolutions=${RESOLUTIONS:-640x480 1280x720 1920x1080 3840x2160 7680x4320}
complexity=${COMPLEXITY:-4} frames=${FRAMES:-15}

# bench OPTIONS...: "triangles complexity frame-ms", from the JSON of a run.
bench() {
    "$program" bench "$@" --frames "$frames" --json --quiet | sed -E \
        's/.*"triangles":([0-9]+).*"depth_complexity":([0-9.e+-]+).*"frame_ms_median":([0-9.e+-]+).*/\1 \2 \3/'
}

# row LABEL COUNT OPTIONS...: one line of a table; COUNT (of millions a second) is "triangles" or a
# number.
row() {
    local label=$1 count=$2 triangles depth one two
    shift 2
    read -r triangles depth one < <(bench "$@" --threads 1)
    read -r _ _ two < <(bench "$@" --threads 2)
    [ "$count" = triangles ] && count=$triangles
    awk -v label="$label" -v depth="$depth" -v one="$one" -v two="$two" -v count="$count" 'BEGIN {
        printf "| %s | %.2f | %.2f | %.2f | %.2f | %.1f |\n",
            label, depth, one, two, one / two, count / two / 1000 }'
}

echo "Triangles: \`sightline bench --generate N --complexity $complexity\` at 1920 x 1080"
echo
echo "| triangles | depth complexity | 1 thread, ms | 2 threads, ms | second thread | million triangles/s |"
echo "|---|---|---|---|---|---|"
for size in $sizes; do
    row "$size" triangles --generate "$size" --complexity "$complexity" --resolution 1920x1080
done
echo
echo "Pixels: \`sightline bench $(basename "$model") --resolution WxH\`"
echo
echo "| resolution | depth complexity | 1 thread, ms | 2 threads, ms | second thread | million pixels/s |"
echo "|---|---|---|---|---|---|"
for resolution in $resolutions; do
    row "$resolution" $((${resolution%x*} * ${resolution#*x})) "$model" --resolution "$resolution"
done
