#!/usr/bin/env bash
# A ground in the model costs nothing, and shadows of what keeps still stay: by compare and motion.
. "$(dirname "$0")/common.sh"

box() { # name x0 y0 z0 x1 y1 z1: adds a box to the model
  awk -v x0=$2 -v y0=$3 -v z0=$4 -v x1=$5 -v y1=$6 -v z1=$7 -v n="$(grep -c '^v' "$1" 2>/dev/null)" 'BEGIN {
    for (i = 0; i < 8; i++) print "v", (i % 2 ? x1 : x0), (int(i / 2) % 2 ? y1 : y0), (i > 3 ? z1 : z0)
    split("1 3 4 2 5 6 8 7 1 2 6 5 3 7 8 4 1 5 7 3 2 4 8 6", f, " ")
    for (i = 0; i < 6; i++) print "f", n + f[4*i+1], n + f[4*i+2], n + f[4*i+3], n + f[4*i+4] }' >>"$1"
}
mae() { grep -o '"mae":[^,]*' "$1" | head -1 | grep -o '[0-9.e-]*$'; }

# The same two boxes with and without 800 units of ground below them, which the camera sees a few of.
box plain.obj -0.45 0 -0.2 -0.05 0.5 0.2
box plain.obj 0.25 0.3 -0.1 0.5 0.4 0.2
cp plain.obj ground.obj
printf 'v -400 0 -400\nv -400 0 400\nv 400 0 400\nv 400 0 -400\nf -4 -3 -2 -1\n' >>ground.obj
view="--camera-position 0,1.8,2.6 --camera-target 0,.38,0 --light-target 0,0,0"
view="$view --size 160x120 --map 256 --reference-samples 64 --frames 1 -t bitmask --no-cache --quiet"
for light in "--light-center 0,3,0 --light-size 1" "--light sun --light-size .5 --light-center 0,3,0" \
  "--light sun --light-size 2 --light-center 2,3,1"; do
  for model in plain ground; do
    run 0 compare $model.obj $light $view --json $model.json
  done
  awk -v a="$(mae plain.json)" -v b="$(mae ground.json)" 'BEGIN { exit !(b <= 1.2 * a + 0.0005) }' ||
    fail "$light: $(mae ground.json) with a ground, $(mae plain.json) without"
done

# The ground alone, of two huge triangles: all of it is lit, also where they meet.
printf 'v -400 0 -400\nv -400 0 400\nv 400 0 400\nv 400 0 -400\nf 1 2 3\nf 1 3 4\n' >flat.obj
run 0 compare flat.obj --light-center 0,3,0 --light-size 1 $view --json flat.json
grep -q '"pixels":[[:space:]]*0' flat.json || fail "a flat ground has shadows"

# One box moves: the shadow of the other stays, as long as texels keep their size.
for step in 0 1 2 3; do
  box move$step.obj -0.5 0 -0.2 -0.2 0.5 0.1
  box move$step.obj 0.5$((2 * step)) 0.2 -0.1 0.7$((2 * step)) 0.35 0.1
done
for light in "--light rectangle --light-size .6" "--light sun --light-size 8"; do
  run 0 motion move0.obj move1.obj move2.obj move3.obj $light --light-center 0,2,0 --light-target 0,0,0 \
    --camera-position 0,1.4,1.8 --camera-target 0,.2,0 --size 160x120 --map 256 --reference-samples 64 -t bitmask \
    -t pcss --no-cache --quiet --json motion.json
  [ "$(grep -c '^move' out)" = 6 ] || fail "rows of motion: $(cat out)"
  awk '/^move/ && $NF == "same" { same++; if ($5 > 0.1 || $4 < 40) bad++ } END { exit !(same >= 3 && !bad) }' out ||
    fail "still shadows move: $(cat out)"
  [ "$(grep -c '"still"' motion.json)" = 6 ] || fail "results of motion"
done
rejected 2 'motion needs SCENE SCENE' motion move0.obj
finish
