#!/bin/sh
# Builds the program: build/release/bin/sightline. A build folder that exists keeps its options.
set -eu
cd "$(dirname "$0")/.."
log=build/release.log
mkdir -p build
if [ ! -f build/release/build.ninja ]; then
    echo "Configuring build/release"
    # The tests need more packages than the program; scripts/test.sh turns them on.
    cmake --preset release -D SIGHTLINE_TESTS=OFF >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
fi
echo "Building build/release/bin/sightline"
cmake --build build/release --target sightline-program >"$log" 2>&1 || {
    tail -n 40 "$log" >&2
    echo "build: failed, the whole log is in $log" >&2
    exit 1
}
