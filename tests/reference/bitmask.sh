#!/usr/bin/env bash
# The bars of bitmask soft shadows, in the standard set-up: 1024 x 768 pixels, maps of 512 x 512, 1024 rays.
#   bitmask.sh PROGRAM [PART...]    parts: split self fusion focus samples merge; all of them without any
# PENUMBRA_BARS_SIZE: another picture size, to look sooner. Every result is printed; a bar that is missed fails.
set -u
program=$1
shift
parts=${*:-split self fusion focus samples merge}
size=${PENUMBRA_BARS_SIZE:-1024x768}
small=${PENUMBRA_BARS_SIZE:-320x240} # where every scene is looked at
bunny=/usr/share/glmark2/models/bunny.obj
scenes="square boxes cylinder balls silhouette silhouette-standing fence leaves room terrain copies"
. "$(dirname "${BASH_SOURCE[0]}")/measured.sh"

patch=bitmask:primitive=patch,merge=0
quad=bitmask:primitive=quad,merge=0
four=bitmask:primitive=patch,maps=layers,layers=4,merge=0
four_quads=bitmask:primitive=quad,maps=layers,layers=4,merge=0

if rows split; then
  measure split "$size" $bunny --split -t pcss -t $patch -t $quad -t $four -t bitmask -t bitmask:primitive=patch
  bar "bunny split: two maps" "$(value split $patch mae)" "a <= 0.008" 0
  bar "bunny split: two maps, quads" "$(value split $quad mae)" "a <= 0.008" 0
  bar "bunny split: four layers" "$(value split $four mae)" "a <= 0.006" 0
  bar "bunny split: pcss (a) over two maps (b)" "$(value split pcss mae)" "a >= 5 * b" "$(value split $patch mae)"
  bar "bunny split: pcss (a) over two maps, quads (b)" "$(value split pcss mae)" "a >= 5 * b" "$(value split $quad mae)"
  bar "bunny split: pcss (a) over four layers (b)" "$(value split pcss mae)" "a >= 5 * b" "$(value split $four mae)"
  bar "bunny split: default" "$(value split bitmask mae)" "a <= 0.010" 0
  bar "bunny split: merge=1 (a) against merge=0 (b)" "$(value split bitmask mae)" "a <= b + 0.001" \
    "$(value split $quad mae)"
  bar "bunny split: the same with patches" "$(value split bitmask:primitive=patch mae)" "a <= b + 0.001" \
    "$(value split $patch mae)"
  for label in bitmask bitmask:primitive=patch; do
    bar "bunny split: $label, blocks visited (a), texels in windows (b)" "$(value split $label visited)" "20 * a <= b" \
      "$(value split $label window)"
  done
fi

if rows self; then
  measure self "$size" $bunny -t $quad -t bitmask
  bar "bunny self: two maps, quads" "$(value self $quad mae)" "a <= 0.012" 0
  bar "bunny self: default" "$(value self bitmask mae)" "a <= 0.015" 0
  bar "bunny self: merge=1 (a) against merge=0 (b)" "$(value self bitmask mae)" "a <= b + 0.001" \
    "$(value self $quad mae)"
fi

if rows fusion; then
  for scene in balls silhouette silhouette-standing; do
    measure $scene "$size" builtin:$scene -t $quad -t $four_quads
    [ $scene = silhouette-standing ] && break
    bar "$scene: two maps" "$(value $scene $quad mae)" "a <= 0.012" 0
    bar "$scene: four layers" "$(value $scene $four_quads mae)" "a <= 0.012" 0
  done
  bar "silhouette-standing: four layers (a) beat two maps (b)" "$(value $scene $four_quads mae)" "a < b" \
    "$(value $scene $quad mae)"
fi

if rows focus; then
  all=bitmask:maps=layers,layers=4
  for scene in $bunny builtin:balls builtin:silhouette builtin:boxes builtin:leaves builtin:room builtin:copies; do
    name=${scene##*[:/]}
    measure focus-$name "$small" $scene -t bitmask:maps=front -t $all,focus=50 -t $all,focus=75 -t $all
    bar "$name: later layers over half of the map (a), one layer (b)" "$(value focus-$name $all,focus=50 mae)" \
      "a <= b" "$(value focus-$name bitmask:maps=front mae)"
    bar "$name: later layers over three quarters (a), over half (b)" "$(value focus-$name $all,focus=75 mae)" "a <= b" \
      "$(value focus-$name $all,focus=50 mae)"
    bar "$name: all of the later layers (a), three quarters (b)" "$(value focus-$name $all mae)" "a <= b + 0.0001" \
      "$(value focus-$name $all,focus=75 mae)"
  done
fi

if rows samples; then
  for scene in $scenes; do
    measure samples-$scene "$small" builtin:$scene -t bitmask -t bitmask:samples=32
    bar "$scene: 16 x 16 jittered (a) against 32 x 32 (b)" \
      "$(value samples-$scene bitmask mae)" "a - b <= 0.002 && b - a <= 0.002" \
      "$(value samples-$scene bitmask:samples=32 mae)"
  done
fi

if rows merge; then
  for scene in $scenes; do
    measure merge-$scene "$small" builtin:$scene -t $quad -t bitmask
    bar "$scene: merge=1 (a) against merge=0 (b)" "$(value merge-$scene bitmask mae)" "a <= b + 0.001" \
      "$(value merge-$scene $quad mae)"
  done
fi

echo "$missed bars missed"
[ $missed -eq 0 ]
