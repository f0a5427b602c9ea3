#!/bin/sh
# The rooms of a folder of sources, held against what is to be so. Says what is wrong, and exits with 1 then.
#
#   rooms.sh includes FOLDER                no circle of includes: X.c with X.h is one unit, a .glsl file is one
#   rooms.sh symbols OBJECTS                no circle of symbols between object files
#   rooms.sh arrows FOLDER TABLE [OBJECTS]  what includes and symbols use of another room is allowed by the table
#   rooms.sh gl FOLDER ROOM                 only FOLDER/ROOM/ calls GL and knows its names
#   rooms.sh names ARCHIVE HEADER           outside names begin with pni_, or with pn_ where the header declares them
#   rooms.sh columns [FOLDER]               no line is longer than 120 columns
#
# OBJECTS is a file with the path of an object file, or of an archive of them, on each line. NM: the nm to use.
set -u
here=$(dirname "$0")
: "${NM:=nm}"
tab=$(printf '\t')
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT

fail() {
  echo "rooms.sh: $*" >&2
  exit 2
}

# Nothing to look at is a mistake in the call, never a success.
some() { [ -s "$1" ] || fail "$2"; }

sources() { find "$1" -name '*.[ch]' -o -name '*.glsl' | LC_ALL=C sort; }

# "unit TAB unit TAB why", one line for each include of a file of the folder.
include_edges() {
  sources "$1" >"$work/files"
  some "$work/files" "no sources in $1"
  awk -v folder="${1%/}/" -f "$here/includes.awk" "$work/files"
}

# The same for each symbol that one object file defines and another uses.
symbol_edges() {
  some "$1" "no object files in $1"
  while read -r object; do
    "$NM" -A -P -g "$object" || fail "$NM cannot read $object"
  done <"$1" >"$work/nm"
  some "$work/nm" "no symbols in $1"
  awk -f "$here/symbols.awk" "$work/nm"
}

# The exit status of most checks: what they found is printed, and nothing may have been.
nothing_in() {
  cat "$1"
  [ ! -s "$1" ]
}

circles() {
  some "$work/edges" "$1: no unit uses another"
  awk -F "$tab" -f "$here/circles.awk" "$work/edges" >"$work/found"
  nothing_in "$work/found"
}

check=${1:-}
[ $# -gt 0 ] && shift
case $check in
  includes)
    include_edges "$1" >"$work/edges" || exit
    circles "$1"
    ;;
  symbols)
    symbol_edges "$1" >"$work/edges" || exit
    circles "$1"
    ;;
  arrows)
    include_edges "$1" >"$work/edges" || exit
    if [ -n "${3:-}" ]; then symbol_edges "$3" >>"$work/edges" || exit; fi
    awk -F "$tab" -f "$here/arrows.awk" "$2" "$work/edges" >"$work/found" || exit 2
    nothing_in "$work/found"
    ;;
  gl)
    sources "$1" | grep '\.[ch]$' | grep -v "^${1%/}/$2/" >"$work/files"
    some "$work/files" "no sources in $1 outside $2"
    while read -r file; do awk -f "$here/gl.awk" "$file"; done <"$work/files" >"$work/found"
    nothing_in "$work/found"
    ;;
  names)
    "$NM" -A -P -g "$1" >"$work/nm" || fail "$NM cannot read $1"
    grep -q '^#define PN_API' "$2" || fail "$2 is not the public header"
    awk -f "$here/names.awk" "$2" "$work/nm" >"$work/found"
    nothing_in "$work/found"
    ;;
  columns)
    cd "${1:-.}" || exit 2
    # A tree that was unpacked, not checked out, has only what is tracked, but for what is built.
    if [ -e .git ]; then git ls-files; else find . -name build -prune -o -type f -print | sed 's|^\./||'; fi |
      grep -E '(\.(c|h|glsl|cmake|sh|awk)|(^|/)CMakeLists\.txt)$|^script/' | LC_ALL=C sort >"$work/files"
    some "$work/files" "no sources in $PWD"
    tr '\n' '\0' <"$work/files" | LC_ALL=C.UTF-8 xargs -0 grep -sHnE '^.{121}' |
      sed 's/^\([^:]*:[0-9]*\):.*/\1: longer than 120 columns/' >"$work/found"
    nothing_in "$work/found"
    ;;
  *)
    sed -n '2,11s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
