#!/bin/bash
# Format (clang-format) and static analysis (clang-tidy) of the sources; warnings are errors. And
# what the compiler makes of the vector loops.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh build lint
mkdir -p build

echo "Checking the format"
find include src cli tests fuzz examples -name '*.[ch]pp' -print0 |
    xargs -0 clang-format --dry-run -Werror

echo "Comparing the code in README.md with examples/render_ids.cpp"
sed -n '/^```cpp$/,/^```$/p' README.md | sed '1d;$d' | diff - examples/render_ids.cpp

echo "Analysing src/ and cli/ with clang-tidy"
cmake --preset release -B build/lint -D SIGHTLINE_TESTS=OFF >build/lint.log
find src cli -name '*.cpp' -print0 | sort -z |
    xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/lint --quiet 2>build/lint.log

echo "Disassembling the vector loops"
scripts/check-hot-loops.sh build/lint
echo "lint: clean"
