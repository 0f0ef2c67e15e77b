#!/bin/bash
# Random scenes in random views: every algorithm, on every vector instruction set of this machine,
# against brute force.
#
#   scripts/soak.sh 600s     for ten minutes
#   scripts/soak.sh 1e9      a billion samples
#
# A sample is one of a picture that an algorithm made on one instruction set. `bsp` is judged by its
# own bound (tests/support/bsp_differences.hpp). It all happens in batches of ten million; finished
# ones are kept in build/soak/, one folder for each version of the program, and a run that was
# stopped, or is to be longer, goes on from there.
#
# Each difference is told with its seed: `build/release/bin/sightline_soak SEED` makes that view
# alone. Exit status 1 when anything differs.
set -uo pipefail
cd "$(dirname "$0")/.."

usage() {
    echo "usage: scripts/soak.sh SECONDSs|SAMPLES, as in 600s or 1e9" >&2
    exit 2
}
[ $# -eq 1 ] || usage
batch=10000000
seconds='' batches=''
if [[ $1 =~ ^[1-9][0-9]{0,8}s$ ]]; then
    seconds=${1%s}
elif [[ $1 =~ ^[1-9][0-9]*(e[0-9]+)?$ ]]; then
    batches=$(awk -v n="$1" -v b="$batch" 'BEGIN { printf "%.0f", int((n + b - 1) / b) }')
else
    usage
fi

scripts/install-deps.sh build test || exit 2
mkdir -p build
{ cmake --preset release -D SIGHTLINE_TESTS=ON && cmake --build build/release --target sightline_soak; } \
    >build/soak.log 2>&1 || {
    tail -n 40 build/soak.log >&2
    exit 2
}
program=build/release/bin/sightline_soak
folder=build/soak/$(sha256sum "$program" | cut -c1-12)
mkdir -p "$folder"
rm -f "$folder"/*.part

# Takes every so-manieth batch that is not there, until time or batches are up. A batch has a
# million seeds of its own, more than it ever needs.
work() {
    local b=$1 file
    while [ -z "$seconds" ] || [ "$SECONDS" -lt "$seconds" ]; do
        [ -z "$batches" ] || [ "$b" -lt "$batches" ] || return 0
        file=$folder/$b.txt
        if [ ! -f "$file" ]; then
            "$program" $((b * 1000000)) "$batch" >"$file.part" &
            trap 'kill $! 2>/dev/null; exit 130' INT TERM
            wait $!
            # 1: something differs. Beyond, the view itself went wrong.
            [ $? -le 1 ] || {
                echo "soak: batch $b failed: $program $((b * 1000000)) $batch" >&2
                return 1
            }
            grep '^seed' "$file.part"
            mv "$file.part" "$file"
        fi
        b=$((b + workers))
    done
}

workers=$(nproc)
SECONDS=0
failed=0 pids=()
for ((w = 0; w < workers; ++w)); do
    work "$w" &
    pids+=($!)
done
trap 'kill "${pids[@]}" 2>/dev/null; exit 130' INT TERM
for pid in "${pids[@]}"; do wait "$pid" || failed=1; done

files=()
for file in "$folder"/*.txt; do
    [ -f "$file" ] || continue
    [ -z "$batches" ] || [ "$(basename "$file" .txt)" -lt "$batches" ] || continue
    files+=("$file")
done
[ ${#files[@]} -gt 0 ] || {
    echo "soak: no batch was finished: give it more time" >&2
    exit 2
}
cat "${files[@]}" | awk -F '\t' -v failed="$failed" '
    $1 == "row" {
        key = sprintf("%-18s %-8s", $2, $3)
        views[key] += $4; samples[key] += $5; differing[key] += $6
        all += $5; differ += $6
    }
    $1 == "views" { v += $2; distinct += $3; covered += $4; models += $5; both += $6; grazed += $7 }
    END {
        print "algorithm          target        views       samples  differ"
        sort = "sort"
        for (key in views)
            printf "%s %10d %13d %7d\n", key, views[key], samples[key], differing[key] | sort
        close(sort)
        printf "%d views of %d samples: %.0f %% covered, %.1f %% of real models, ", v, distinct,
            100 * covered / distinct, 100 * models / v
        printf "%.0f %% with clipped and tiny triangles\n", 100 * both / v
        printf "bsp: %d samples covered by snapping alone\n", grazed
        printf "soak: %d samples compared, %d differ\n", all, differ
        exit differ > 0 || failed
    }'
