# What the scripts of bars share: a program's results by technique, and bars over them. Sourced after `program` and
# `parts` are set. Every result is printed; a bar that is missed counts.
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export XDG_CACHE_HOME=$work/cache
missed=0

# measure NAME SIZE SCENE OPTIONS...: what each technique got, as lines "label key value" in the file NAME
measure() {
  local name=$1 size=$2 scene=$3
  shift 3
  "$program" compare "$scene" --size "$size" --frames 1 --quiet --json "$work/$name.json" "$@" >"$work/out" || {
    echo "FAILED: penumbra compare $scene $*"
    exit 1
  }
  awk '/"label":/ { label = $2; gsub(/"|",?$/, "", label) }
       /"(mae|max|visited|window|primitives|covered|median|depth_map|extents|accumulate)":[ \t]*[0-9]/ {
         key = $1
         gsub(/[":]/, "", key)
         print label, key, $2 + 0
       }' \
    "$work/$name.json" >"$work/$name"
  awk -v name="$name" '$2 == "mae" { label = $1; mae = $3 }
       $2 == "max" && label != "" { printf "  %-28s %-58s %.4f  max %.3f\n", name, label, mae, $3; label = "" }' \
    "$work/$name"
}

value() { # NAME LABEL KEY
  awk -v label="$2" -v key="$3" '$1 == label && $2 == key { print $3; found = 1 } END { if (!found) print "missing" }' \
    "$work/$1"
}

# With known=1 before it a bar that is missed is shown as such, and does not count: the page of the technique says why.
bar() { # TEXT A CONDITION OF a AND b, B
  local verdict=ok
  awk -v a="$2" -v b="$4" "BEGIN { exit !(a != \"missing\" && b != \"missing\" && ($3)) }" || {
    verdict=MISSED
    [ -n "${known:-}" ] && verdict=KNOWN || missed=$((missed + 1))
  }
  printf '%-6s %-70s a = %-10.7s b = %-10.7s %s\n' "$verdict" "$1" "$2" "$4" "$3"
}

rows() { case " $parts " in *" $1 "*) echo "== $1" ;; *) return 1 ;; esac; }

