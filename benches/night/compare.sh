#!/bin/sh
# One run of the same parts through resurf and through a FreeCAD script that opens and exports them again:
#   benches/night/compare.sh RESURF FOLDER
# prints wall and processor seconds of both.
set -eu
resurf=$1
parts=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
find "$parts" -type f \( -iname '*.step' -o -iname '*.stp' \) | sort >"$work/parts"
mkdir "$work/freecad"
{
    echo 'version = 1'
    echo 'output = "resurf/{stem}.{ext}"'
    echo 'inputs = ['
    sed 's/.*/  "&",/' "$work/parts"
    echo ']'
} >"$work/job.toml"
measure() {
    name=$1
    shift
    bash -c 'TIMEFORMAT="%R s wall, %U s user, %S s system"; time "$@" >"$0" 2>&1 || true' "$work/$name.log" "$@" 2>"$work/time"
    echo "$name: $(cat "$work/time"), $(find "$work/$name" -iname '*.st*p' | wc -l) of $(wc -l <"$work/parts") parts written"
}
measure resurf "$resurf" run "$work/job.toml"
measure freecad env PARTS="$work/parts" OUT="$work/freecad" freecadcmd "$here/reexport.py"
