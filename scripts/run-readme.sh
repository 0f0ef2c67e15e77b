#!/bin/sh
# Runs every command of a document that begins with `sightline`, as it is written, and leaves the
# pictures and drawings in a folder: so what the document shows is true.
#
#   scripts/run-readme.sh FOLDER [DOCUMENT]      (default: README.md)
set -eu
cd "$(dirname "$0")/.."
root=$PWD
folder=${1:?usage: scripts/run-readme.sh FOLDER [DOCUMENT]}
document=${2:-README.md}
mkdir -p "$folder"

# The commands name samples/ and write beside it, so they run in a folder that shows only that.
work=$(mktemp -d "${TMPDIR:-/tmp}/sightline-readme.XXXXXX")
trap 'rm -rf "$work"' EXIT
ln -s "$root/samples" "$work/samples"
PATH=$root/build/release/bin:$PATH
export PATH

# A backslash at the end of a line continues it: `read` without -r joins such lines.
sed -n '/^```sh$/,/^```$/p' "$document" >"$work/blocks"
while read command; do
    case $command in
        'sightline '*)
            command=$(echo "$command" | tr -s ' ')
            echo "  $command"
            (cd "$work" && sh -c "$command" </dev/null >"$work/output" 2>&1) || {
                cat "$work/output" >&2
                echo "run-readme: failed: $command" >&2
                exit 1
            }
            ;;
    esac
done <"$work/blocks"
rm -f "$folder"/*.png "$folder"/*.svg
find "$work" -maxdepth 1 '(' -name '*.png' -o -name '*.svg' ')' -exec cp '{}' "$folder" ';'
