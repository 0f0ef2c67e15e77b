#!/bin/sh
# Draws how each algorithm of the registry decides the sample house, where the painter is wrong,
# and translucent surfaces: the pictures of docs/algorithms/. The exhaustive ones have nothing to
# show.
#
#   scripts/draw-algorithms.sh FOLDER
set -eu
cd "$(dirname "$0")/.."
folder=${1:?usage: scripts/draw-algorithms.sh FOLDER}
scripts/install-deps.sh build test
cmake --preset release -D SIGHTLINE_TESTS=ON >/dev/null
cmake --build build/release --target watch_algorithm >/dev/null
build/release/bin/sightline algorithms --json |
    tr '{' '\n' | grep '"exhaustive": *false' | sed -E 's/.*"name": *"([^"]*)".*/\1/' |
    grep -v '^abuffer$' | # its steps are the z-buffer's
    while read -r name; do
        build/release/bin/watch_algorithm samples/house.obj "$name" "$folder/$name.png"
    done
build/release/bin/sightline compare samples/house.obj --algorithms painter,zbuffer \
    --difference "$folder/painter-difference.png" --quiet >/dev/null
build/release/bin/sightline render samples/crossing.obj --opacity 0.5 --algorithm depth-sort \
    --samples 16 -o "$folder/transparency.png"
# Smooth edges: one sample a pixel, 16, and areas.
look="--shading unlit --eye 5,2.2,28 --target 0,-0.5,0 --fov 14 --resolution 280x90 --quiet"
for samples in 1 16; do
    # shellcheck disable=SC2086 # words
    build/release/bin/sightline render samples/board.obj $look --samples $samples \
        -o "$folder/abuffer-$samples.png"
done
# shellcheck disable=SC2086 # words
build/release/bin/sightline render samples/board.obj $look --algorithm abuffer \
    -o "$folder/abuffer-area.png"
# Few curves: with the surface between them, and without.
for way in "" -image; do
    # shellcheck disable=SC2046 # a word or none
    build/release/bin/sightline plot "y = 8*sin(hypot(x,z))/hypot(x,z)" --count 12 \
        --projection orthographic --direction 0,-0.35,-1 --axes none --zoom 1.6 \
        --resolution 480x300 --background '#ffffff' $([ -z "$way" ] || echo --image-space) \
        -o "$folder/floating-horizon$way.png" --quiet
done
