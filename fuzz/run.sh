#!/bin/sh
# Runs every fuzz target for some seconds: fuzz/run.sh SECONDS BUILD_DIR [TARGET...]
# Starts from the seeds in fuzz/corpus; new inputs and findings stay in BUILD_DIR/fuzz-work.
# Status 1 when a target has a finding.
set -eu
if [ $# -lt 2 ]; then
    echo "usage: fuzz/run.sh SECONDS BUILD_DIR [TARGET...]" >&2
    exit 2
fi
seconds=$1
build=$(cd "$2" && pwd)
shift 2
here=$(cd "$(dirname "$0")" && pwd)
[ $# -gt 0 ] || set -- height_map_fuzz load_fuzz mtl_fuzz obj_fuzz ply_fuzz scene_json_fuzz \
    soup_fuzz stl_fuzz

# A reader that asks for absurd memory gets none and dies in its child process, where that belongs.
ASAN_OPTIONS="allocator_may_return_null=1:${ASAN_OPTIONS:-}"
export ASAN_OPTIONS
status=0
for target in "$@"; do
    work="$build/fuzz-work/$target"
    mkdir -p "$work/corpus" "$work/findings"
    echo "== $target, $seconds s"
    if ! "$build/bin/$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 \
        -malloc_limit_mb=100000 -print_final_stats=1 -verbosity=0 \
        -artifact_prefix="$work/findings/" "$work/corpus" "$here/corpus/$target"; then
        echo "$target: a finding, see $work/findings" >&2
        status=1
    fi
done
exit $status
