#!/bin/bash
# Runs every model below a folder through info, render, draw and visible, and tabulates how it went.
#
#   scripts/corpus.sh DIR [OUT]
#
# OUT (default build/corpus) gets outcomes.tsv, one line a file: the outcomes of the four commands,
# triangles, bounds, and what was said. A table that stands there already is compared with the new
# one. Outcomes:
#
#   ok        status 0, and the picture shows something
#   warned    status 0, the picture or drawing is empty, and a line says so
#   refused   status 1 or 2 with one line that names the file or an option
#   BLANK     status 0, nothing is shown, and nothing is said
#   MUTE      status 1 or 2 without such a line, or with more than one
#   CRASH     ended by a signal
#   HANG      took longer than SECONDS (150: the readers end by themselves after 120)
#
# Those in capitals are faults; the status is 1 if there are any. SIGHTLINE names the program.
set -uo pipefail
cd "$(dirname "$0")/.."
if [ $# -lt 1 ] || [ ! -d "$1" ]; then
    echo "usage: scripts/corpus.sh DIR [OUT]" >&2
    exit 2
fi
folder=$(cd "$1" && pwd)
out=${2:-build/corpus}
export SIGHTLINE=${SIGHTLINE:-$PWD/build/release/bin/sightline} SECONDS_EACH=${SECONDS_EACH:-150}
endings='obj|ply|stl|off|gltf|glb|3mf|amf|dae|zae|fbx|3ds|ac|ase|b3d|blend|cob|dxf|iqm|irr|irrmesh'
endings+='|lwo|lws|lxo|md2|md3|md5mesh|mdl|ms3d|nff|q3o|q3s|raw|smd|ter|wrl|x|x3d|x3db|xgl|zgl'
mkdir -p "$out"
out=$(cd "$out" && pwd)

# run FILE COMMAND ARGUMENT...: runs the program; its status and its words are in $scratch.
run() {
    (ulimit -v 25165824; exec timeout -k 5 "$SECONDS_EACH" "$SIGHTLINE" "${@:2:1}" "$1" "${@:3}") \
        >"$scratch/out" 2>"$scratch/err" </dev/null
    status=$?
}

# outcome SHOWN: the word for the last run; SHOWN tells whether it showed anything.
outcome() {
    local lines
    lines=$(wc -l <"$scratch/err")
    case $status in
        0)
            if [ "$1" = yes ]; then
                echo ok
            elif [ "$lines" -gt 0 ]; then
                echo warned
            else
                echo BLANK
            fi
            ;;
        1 | 2)
            if [ "$(grep -vc '^sightline: warning: ' "$scratch/err")" -eq 1 ]; then
                echo refused
            else
                echo MUTE
            fi
            ;;
        124 | 137) echo HANG ;;
        *) echo CRASH ;;
    esac
}

try() {
    local file=$1 folder=$2 info render draw visible triangles low high words shown
    scratch=$(mktemp -d)
    run "$file" info --json
    info=$(outcome yes)
    triangles=$(grep -o '"triangles":[0-9]*' "$scratch/out" | tail -n 1 | cut -d: -f2)
    low=$(grep -o '"bounds":{"min":\[[^]]*' "$scratch/out" | sed 's/.*\[//')
    high=$(grep -o '"bounds":{"min":[^}]*' "$scratch/out" | sed 's/.*\[//; s/\]$//')
    words=$(head -n 1 "$scratch/err" | cut -c 1-200)
    run "$file" render --resolution 160x120 -o "$scratch/p.png" --ids "$scratch/i.npy"
    # An id is four bytes; nothing at all is seen where all of them are 255.
    shown=no
    [ "$(tail -c +129 "$scratch/i.npy" 2>"/dev/null" | tr -d '\377' | wc -c)" -gt 0 ] && shown=yes
    render=$(outcome $shown)
    run "$file" draw -o "$scratch/d.svg"
    shown=no
    grep -qs '<path' "$scratch/d.svg" && shown=yes
    draw=$(outcome $shown)
    run "$file" visible --resolution 160x120 --json
    shown=no
    grep -q '"visible":true' "$scratch/out" && shown=yes
    visible=$(outcome $shown)
    printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "${file#"$folder"/}" "$info" "$render" "$draw" \
        "$visible" "${triangles:--}" "${low:--}" "${high:--}" "${words//"$file"/FILE}"
    rm -rf "$scratch"
}
export -f run outcome try

[ ! -f "$out/outcomes.tsv" ] || mv "$out/outcomes.tsv" "$out/outcomes.last.tsv"
find "$folder" -type f -regextype posix-extended -iregex ".*\.($endings)" -print0 | sort -z |
    xargs -0 -P "$(nproc)" -I{} bash -c 'try "$@"' try {} "$folder" | sort >"$out/outcomes.tsv"

echo "$(wc -l <"$out/outcomes.tsv") files; info, render, draw and visible of them:"
awk -F'\t' '{ for (i = 2; i <= 5; ++i) ++n[$i] } END { for (w in n) print "  " n[w] "\t" w }' \
    "$out/outcomes.tsv" | sort -rn
if [ -f "$out/outcomes.last.tsv" ]; then
    echo "Compared with the last table:"
    diff "$out/outcomes.last.tsv" "$out/outcomes.tsv" | grep '^[<>]' || echo "  the same"
fi
if grep -P '\t(BLANK|MUTE|CRASH|HANG)\t' "$out/outcomes.tsv"; then
    exit 1
fi
