#!/usr/bin/env bash
# The bars of soft shadow maps: 1024 x 768 pixels, 1024 rays, maps as each bar says.
#   ssm.sh PROGRAM [PART...]    parts: split sides square sizes light sums self merge extents linear; all without any
# PENUMBRA_BARS_SIZE: another picture size, to look sooner. Times are medians of one run, one technique after the other
# in turn; the machine should have nothing else to do.
set -u
program=$1
shift
parts=${*:-split sides square sizes light sums self merge extents linear}
size=${PENUMBRA_BARS_SIZE:-1024x768}
small=${PENUMBRA_BARS_SIZE:-320x240} # where every scene is looked at
bunny=/usr/share/glmark2/models/bunny.obj
scenes="square boxes cylinder balls silhouette silhouette-standing fence leaves room terrain copies"
. "$(dirname "${BASH_SOURCE[0]}")/measured.sh"

both=ssm:merge=0,layers=1
front=ssm:merge=0,layers=1,sides=front

if rows split; then
  measure split "$size" $bunny --split --map 256 -t $both -t $front -t ssm
  bar "bunny split, 256: two-sided" "$(value split $both mae)" "a <= 0.042" 0
  bar "bunny split, 256: one-sided" "$(value split $front mae)" "a <= 0.064" 0
  bar "bunny split, 256: default" "$(value split ssm mae)" "a <= 0.042" 0
  # From above: the camera beside the light, which hides as little of the ground as can be.
  measure above "$size" $bunny --split --map 256 --light-size 1.6 --camera-position 0,5,0.01 -t $both
  known=1 bar "bunny split from above, light 0.8 H" "$(value above $both mae)" "a <= 0.031" 0
fi

if rows sides; then
  measure time "$size" $bunny --split --map 256 --frames 15 -t $both -t $front
  bar "time: two-sided (a) over one-sided (b)" "$(value time $both median)" "a <= 1.8 * b" "$(value time $front median)"
  for scene in $scenes; do
    [ $scene = terrain ] && continue # it is its own receiver: nothing to split
    measure sides-$scene "$small" builtin:$scene --split --map 256 -t ssm -t ssm:sides=front
    known= # steep walls that stand on the floor are counted more than once, from the farther side too
    [ $scene = cylinder ] && known=1
    bar "$scene: two-sided (a), one-sided (b)" "$(value sides-$scene ssm mae)" "a <= b + 0.002" \
      "$(value sides-$scene ssm:sides=front mae)"
    known=
  done
fi

# The paper's discretisation peaks: the frustum stays while the map's texels move over the square's edges.
if rows square; then
  rm -f "$work/square"
  for map in $(seq 230 281); do
    "$program" compare builtin:square --split --quiet --size "$size" --frames 1 --map $map \
      --fit=-0.5,0.59,-0.5,0.5,0.61,0.5 --json "$work/square.json" -t ssm >/dev/null || exit 1
    awk -v map=$map '/"mae":/ { print $2 + 0, map }' "$work/square.json" >>"$work/square"
  done
  sort -g "$work/square" | awk '{ v[NR] = $1; m[NR] = $2 }
    END {
      printf "  least %.4f at %d, median %.4f, most %.4f at %d\n", v[1], m[1], v[int((NR + 1) / 2)], v[NR], m[NR]
    }'
  bar "square, maps 230 to 281: most" "$(sort -g "$work/square" | tail -1 | cut -d' ' -f1)" "a <= 0.008" 0
  bar "square, maps 230 to 281: median" "$(sort -g "$work/square" | sed -n 26p | cut -d' ' -f1)" "a <= 0.004" 0
fi

# Fig. 17: falls to about 200, then flattens; under a light a quarter of the bunny wide, that texels matter to.
if rows sizes; then
  for map in 50 100 200 400; do measure size-$map "$size" $bunny --split --map $map --light-size 0.5 -t $both; done
  bar "bunny split, map 50 (a), 200 (b)" "$(value size-50 $both mae)" "a > b" "$(value size-200 $both mae)"
  bar "bunny split, map 200 (a), 400 (b)" "$(value size-200 $both mae)" "a <= 1.15 * b" "$(value size-400 $both mae)"
fi

if rows light; then # Figs. 18 to 20
  for light in 0.5 1 2 4; do measure light-$light "$size" $bunny --split --map 128 --light-size $light -t $both; done
  for pair in "0.5 1" "1 2" "2 4"; do
    set -- $pair
    bar "light $1 (a), $2 (b)" "$(value light-$1 $both mae)" "a < b" "$(value light-$2 $both mae)"
  done
  for x in 0 2 4; do
    measure aside-$x "$size" $bunny --split --map 128 --light-center $x,5,0 --light-target $x,-1,0 -t $both
  done
  known=1 bar "light above (a), aside (b)" "$(value aside-0 $both mae)" "a < b" "$(value aside-2 $both mae)"
  known=1 bar "light aside (a), farther (b)" "$(value aside-2 $both mae)" "a < b" "$(value aside-4 $both mae)"
  for y in 5 3 2; do
    measure near-$y "$size" $bunny --split --map 128 --light-size 1 --light-center 0,$y,0 -t $both
  done
  bar "light far (a), near (b)" "$(value near-5 $both mae)" "a < b" "$(value near-3 $both mae)"
  bar "light near (a), nearer (b)" "$(value near-3 $both mae)" "a < b" "$(value near-2 $both mae)"
fi

if rows sums; then # Fig. 14
  measure sums "$size" $bunny --split --map 512 -t $both -t $both,accumulate=fp16 -t $both,accumulate=fp16-batched
  bar "512: 16 bits (a) against 32 (b)" "$(value sums $both,accumulate=fp16 mae)" "a > 2 * b" "$(value sums $both mae)"
  bar "512: by batches (a) against 32 bits (b)" "$(value sums $both,accumulate=fp16-batched mae)" "a <= b + 0.004" \
    "$(value sums $both mae)"
fi

if rows self; then
  measure self "$size" $bunny --map 512 -t ssm -t ssm:preset=fast
  bar "bunny self, 512" "$(value self ssm mae)" "a <= 0.06" 0
fi

if rows merge; then
  measure merge "$size" $bunny --split --map 512 --frames 3 -t ssm:merge=1,layers=1 -t $both -t ssm:layers=1
  bar "covered texels: merge=1 (a), merge=0 (b)" "$(value merge ssm:merge=1,layers=1 covered)" "5 * a <= b" \
    "$(value merge $both covered)"
  bar "time: merge=1 (a), merge=0 (b)" "$(value merge ssm:merge=1,layers=1 median)" "3 * a <= b" \
    "$(value merge $both median)"
  bar "error: default (a), merge=0 (b)" "$(value merge ssm:layers=1 mae)" "a - b <= 0.002 && b - a <= 0.002" \
    "$(value merge $both mae)"
  bar "error: merge=1 (a), merge=0 (b)" "$(value merge ssm:merge=1,layers=1 mae)" "a - b <= 0.002 && b - a <= 0.002" \
    "$(value merge $both mae)"
fi

if rows extents; then
  for map in 64 128 256 512 1024; do
    measure extents-$map "$size" $bunny --split --map $map --frames 15 --reference-samples 1 -t ssm -t ssm:extents=cpu
    bar "map $map: extents on the GPU (a), on the CPU (b)" "$(value extents-$map ssm median)" "a <= 1.1 * b" \
      "$(value extents-$map ssm:extents=cpu median)"
  done
fi

if rows linear; then # section 6: texels times covered texels, and triangles
  for map in 64 128 256 512; do
    measure linear-$map "$size" $bunny --split --map $map --frames 5 --reference-samples 1 -t $front,size=128
    echo "  map $map: $(value linear-$map $front,size=128 covered) covered," \
      "$(value linear-$map $front,size=128 accumulate) ms"
  done
  bar "16 times the texels: time at 128 (a), at 512 (b)" \
    "$(value linear-128 $front,size=128 accumulate)" "b <= 20 * a" \
    "$(value linear-512 $front,size=128 accumulate)"
  for copies in 16 64 256; do
    measure copies-$copies "$size" builtin:copies=$copies --split --map 128 --frames 15 --reference-samples 1 -t $front
    echo "  $copies copies: maps $(value copies-$copies $front depth_map) ms," \
      "all $(value copies-$copies $front median) ms"
  done
fi

echo "$missed bars missed"
[ $missed -eq 0 ]
