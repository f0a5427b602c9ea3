#!/usr/bin/env bash
# What a host without a normal texture loses: on built-in scenes (docs/space.md has all of them) the error with planes
# from depth is at most 1.25 times the one with exact normals, plus 0.002.
. "$(dirname "$0")/common.sh"

# mae FILE [2]: 2: over all pixels that face any of the light
mae() { grep -o '"mae":[^,]*' "$1" | sed -n "${2:-1}p" | grep -o '[0-9.e-]*$'; }

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
  # The sides of a cylinder below a light see a part of it only; a plane that sees more of it is darkened.
  [ $scene != cylinder ] ||
    awk -v a="$(mae given.json 2)" -v b="$(mae depth.json 2)" 'BEGIN { exit !(b <= a + 0.002) }' ||
    fail "$scene, all: $(mae depth.json 2) from depth, $(mae given.json 2) with normals"
done

finish
