#!/usr/bin/env bash
# What smoothies may cost, in ratios of medians that were measured in turn in one run.
#   smoothies.sh PROGRAM
# The smoothie passes at most 2.5 times the depth map of the same mesh, of 70,000 triangles; the whole technique at most
# twice hard; and four times the edges at most six times the time. Every ratio is printed.
set -u
program=$1
bunny=/usr/share/glmark2/models/bunny.obj
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
missed=0

# stage LABEL STAGE of the last measurement
stage() {
  awk -v label="\"$1\"," -v stage="\"$2\":" '$1 == "\"label\":" { here = $2 == label }
    here && $1 == stage { value = $2 }
    END { print value + 0 }' "$work/bench.json"
}
total() {
  awk -v label="\"$1\"," '$1 == "\"label\":" { here = $2 == label }
    here && $1 == "\"median\":" && !seen { value = $2; seen = here }
    END { print value + 0 }' "$work/bench.json"
}
bar() { # TEXT A B MOST
  awk -v text="$1" -v a="$2" -v b="$3" -v most="$4" 'BEGIN {
    ratio = b > 0 ? a / b : 0
    ok = ratio > 0 && ratio <= most
    printf "%-6s %-60s %8.2f / %8.2f = %.2f, at most %s\n", ok ? "ok" : "MISSED", text, a, b, ratio, most
    exit !ok
  }' ||
    missed=$((missed + 1))
}
measure() { # SCENE OPTIONS...
  "$program" bench "$@" --quiet --json "$work/bench.json" >"$work/out" || { cat "$work/out"; exit 1; }
}

# A bumpy sphere of N x 2 N quads.
sphere() {
  awk -v n="$1" 'BEGIN {
    pi = atan2(0, -1)
    for (i = 0; i <= n; i++) for (j = 0; j < 2 * n; j++) {
      a = pi * i / n; b = pi * j / n; r = 1 + 0.1 * sin(5 * a) * sin(4 * b)
      printf "v %.6f %.6f %.6f\n", r * sin(a) * cos(b), r * cos(a), r * sin(a) * sin(b)
    }
    for (i = 0; i < n; i++) for (j = 0; j < 2 * n; j++) {
      p = 2 * n * i + j + 1; q = 2 * n * i + (j + 1) % (2 * n) + 1
      printf "f %d %d %d\nf %d %d %d\n", p, q, p + 2 * n, q, q + 2 * n, p + 2 * n
    }
  }'
}

if [ -r $bunny ]; then
  measure $bunny -t hard -t smoothies -t smoothies:geometry=edges --frames 12
  for label in smoothies smoothies:geometry=edges; do
    bar "bunny, $label: smoothie passes, depth map" "$(stage $label smoothies)" "$(stage hard depth_map)" 2.5
    bar "bunny, $label: whole frame, hard" "$(total $label)" "$(total hard)" 2
  done
fi
for n in 75 150 300; do
  sphere $n >"$work/sphere.obj"
  measure "$work/sphere.obj" -t smoothies --frames 8
  now=$(stage smoothies smoothies)
  echo "       sphere of $((4 * n * n)) triangles: smoothie passes $now ms"
  [ $n -gt 75 ] && bar "sphere, four times the edges" "$now" "$before" 6
  before=$now
done
[ $missed -eq 0 ]
