#!/bin/bash
# Fails when the compiler copies blocks of memory in the vector loops: `rep movs` there is a table
# or an array that is put on the stack at every call, which once took most of a stage's time.
#
#   scripts/check-hot-loops.sh [BUILD]    a build folder of the release preset (default build/lint)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/lint}

case $(uname -m) in
    x86_64 | i?86) ;;
    *)
        echo "Hot loops: 'rep movs' is an instruction of x86, nothing to check"
        exit 0
        ;;
esac
[ -f "$build/build.ninja" ] || {
    echo "check-hot-loops: $build is no build folder: run cmake --preset release -B $build" >&2
    exit 2
}

# Whatever is compiled for every vector width.
objects=$(grep -l 'hwy/foreach_target.h' src/*/*.cpp | sed 's|^src/|src/CMakeFiles/sightline.dir/|; s|$|.o|')
cmake --build "$build" --target $objects >"$build/hot-loops.log" 2>&1 || {
    tail -n 30 "$build/hot-loops.log" >&2
    exit 2
}
bad=0
for object in $objects; do
    objdump --disassemble --no-show-raw-insn "$build/$object" >"$build/hot-loops.s"
    copies=$(grep -c 'rep movs' "$build/hot-loops.s" || true)
    [ "$copies" -eq 0 ] || {
        echo "check-hot-loops: $object copies blocks of memory in $copies places (rep movs)" >&2
        bad=1
    }
done
exit $bad
