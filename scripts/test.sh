#!/bin/bash
# The one test command: installs what is missing, builds, and runs every test.
#
#   scripts/test.sh [--full]
#
# release     all tests, the installed library's consumers, and the same bytes from a scalar build
# fuzz        all tests once more, built by clang with the address and undefined-behaviour
#             sanitizers, and each libFuzzer target for a short while, from the seeds in fuzz/corpus
# tsan        with --full: all tests once more, under the thread sanitizer
#
# With --full the tests of the release also run their heavy cases (SIGHTLINE_FULL=1), and fuzzing
# takes longer.
#
# The last line counts what ran: "N passed, N failed", also left in build/test-summary.txt.
set -uo pipefail
cd "$(dirname "$0")/.."

fuzz_seconds=15
full=no
heavy=()
case ${1:-} in
    '') ;;
    --full)
        full=yes
        fuzz_seconds=120
        heavy=(env SIGHTLINE_FULL=1)
        ;;
    *)
        echo "usage: scripts/test.sh [--full]" >&2
        exit 2
        ;;
esac

passed=0
failed=0
logs=build/test-logs
rm -f build/test-summary.txt
mkdir -p "$logs"

# What a log says about a failure: its errors, or else its end.
show_failure() {
    grep -E -m 10 'error: |CMake Error|ERROR: |SUMMARY: ' "$1" || tail -n 30 "$1"
}

# step TEXT LOG COMMAND...: runs a command quietly; says what went wrong when it fails.
step() {
    local text=$1 log=$logs/$2.log begin=$SECONDS
    shift 2
    echo "$text"
    if "$@" </dev/null >"$log" 2>&1; then
        echo "    done in $((SECONDS - begin)) s"
        return 0
    fi
    show_failure "$log"
    echo "    failed; the whole log is in $log"
    failed=$((failed + 1))
    return 1
}

configure_and_build() {
    local preset=$1 target=$2
    shift 2
    cmake --preset "$preset" "$@" && cmake --build "build/$preset" --target "$target"
}

# Counts test cases in ctest's log of a build: GoogleTest's own where an entry has them, else the
# entry itself. A crash counts as one failure.
count_results() {
    awk '
        / Testing: / { ok = bad = 0 }
        /^\[  PASSED  \] [0-9]+ test/ { ok = $4 }
        /^\[  FAILED  \] [0-9]+ test/ { bad = $4 }
        /^Test (Passed|Failed)\.$/ {
            if ($2 == "Passed.") passed += ok ? ok : 1
            else { passed += ok; failed += bad ? bad : 1 }
        }
        END { print passed + 0, failed + 0 }' "$1"
}

# run_ctest PRESET [env NAME=VALUE...]
run_ctest() {
    local build=build/$1 status=0 ok bad begin=$SECONDS
    echo "Running the tests of $build"
    "${@:2}" ctest --test-dir "$build" -j "$(nproc)" --output-on-failure --no-tests=error || status=1
    read -r ok bad < <(count_results "$build/Testing/Temporary/LastTest.log")
    echo "    done in $((SECONDS - begin)) s"
    # A run that failed without a failing case (a missing program, say) is a failure all the same.
    [ "$status" -eq 0 ] || [ "$bad" -gt 0 ] || bad=1
    passed=$((passed + ok))
    failed=$((failed + bad))
}

# Each target is one case; as many run at a time as there are cores.
run_fuzz() {
    local target targets
    targets=$(cd fuzz && ls ./*_fuzz.cpp | sed 's|^./||; s|\.cpp$||')
    echo "Fuzzing for $fuzz_seconds s each:" $targets
    rm -f "$logs"/*_fuzz.ok
    echo "$targets" | xargs -P "$(nproc)" -I{} sh -c \
        'fuzz/run.sh "$1" build/fuzz {} >"$2/{}.log" 2>&1 && touch "$2/{}.ok"; true' \
        run "$fuzz_seconds" "$logs"
    for target in $targets; do
        if [ -f "$logs/$target.ok" ]; then
            passed=$((passed + 1))
        else
            echo "    $target failed; the whole log is in $logs/$target.log"
            show_failure "$logs/$target.log"
            failed=$((failed + 1))
        fi
    done
}

scripts/install-deps.sh build test || exit 1

step "Building the scalar program" build-scalar \
    configure_and_build scalar sightline-program -D SIGHTLINE_TESTS=OFF
step "Building the program and the tests" build-release configure_and_build release all \
    -D SIGHTLINE_TESTS=ON -D SIGHTLINE_SCALAR_PROGRAM="$PWD/build/scalar/bin/sightline" &&
    run_ctest release "${heavy[@]}"
# The sanitized tests and the fuzz targets share one build of the library, which saves minutes.
if step "Building the tests and the fuzz targets with sanitizers" build-fuzz \
    configure_and_build fuzz all -D SIGHTLINE_TESTS=ON; then
    run_ctest fuzz
    run_fuzz
fi
if [ "$full" = yes ]; then
    step "Building the tests with the thread sanitizer" build-tsan configure_and_build tsan all &&
        run_ctest tsan
fi

minutes=$((SECONDS / 60))
if [ "$failed" -eq 0 ]; then
    echo "make test: everything passed, in $minutes min $((SECONDS % 60)) s"
else
    echo "make test: something failed, in $minutes min $((SECONDS % 60)) s; logs in $logs"
fi
echo "$passed passed, $failed failed" | tee build/test-summary.txt
[ "$failed" -eq 0 ]
