#!/usr/bin/env bash
# What a host without a normal texture loses: on built-in scenes (docs/space.md has all of them) the error with planes
# from depth is at most 1.25 times the one with exact normals, plus 0.002.
. "$(dirname "$0")/common.sh"

mae() { grep -o '"mae":[^,]*' "$1" | head -1 | grep -o '[0-9.e-]*$'; }

# At 160 x 120 the leaves would be smaller than pixels.
for scene in boxes balls cylinder fence leaves terrain copies; do
  size=160x120
  [ $scene = leaves ] && size=320x240
  for normals in given depth; do
    run 0 compare builtin:$scene --normals $normals --size $size --reference-samples 144 --frames 1 -t bitmask \
      --no-cache --quiet --json $normals.json
  done
  awk -v a="$(mae given.json)" -v b="$(mae depth.json)" 'BEGIN { exit !(a > 0 && b <= 1.25 * a + 0.002) }' ||
    fail "$scene: $(mae depth.json) from depth, $(mae given.json) with normals"
done

finish
