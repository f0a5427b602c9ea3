#!/usr/bin/env bash
# What is right: forms of options, help everywhere, lists, and that a result's set-up makes the same picture again.
header=$(cd "$(dirname "$0")/../../include/penumbra" && pwd)/penumbra.h
. "$(dirname "$0")/common.sh"
small="--size 48x36 --map 32 --frames 1 -t hard"

for command in render compare motion study bench view list info help; do
  for form in -h --help; do
    run 0 $command $form
    grep -q "^penumbra $command" out || fail "help of $command"
    [ ! -s err ] || fail "help of $command on stderr"
  done
  run 0 help $command
  grep -q "^penumbra $command" out || fail "help $command"
done
run 0 render --size 3x --help # help wins over what else is wrong
run 0 --help
[ "$(grep -c 'not in this version' out)" = 2 ] || fail "the overview offers what is not there: $(cat out)"
run 0 -h
run 0 --version
grep -qE '^penumbra [0-9]+\.[0-9]+\.[0-9]+$' out || fail "version: $(cat out)"
run 2
grep -q 'penumbra render' err || fail "no overview without arguments"

# Each technique has help and stands in the list; verbose shows its parameters.
run 0 list techniques
awk '{print $1}' out >techniques
grep -qx pcss techniques || fail "pcss is not listed"
while read -r technique; do
  run 0 help "$technique"
  grep -q "^$technique: " out || fail "help $technique"
done <techniques
run 0 help bitmask
grep -qE '^      (fast|quality|best): [a-z_]+=' out || fail "help does not say what presets set: $(cat out)"
run 0 list techniques --verbose
grep -qE '^  samples=1\.\.64 +default 8' out || fail "parameter tables: $(cat out)"
run 0 list scenes
scenes="balls boxes copies cylinder fence leaves room silhouette silhouette-standing square terrain "
[ "$(awk '{print $1}' out | LC_ALL=C sort | tr '\n' ' ')" = "$scenes" ] || fail "scenes: $(cat out)"
run 0 list studies
run 0 info
grep -q 'devices (--device N)' out || fail "info: $(cat out)"

# --name=V, --name V, -oV, V that starts with -, and the same picture each time.
run 0 render builtin:boxes $small -o a.exr --light-center=-0.5,3,0 --light-size 0.5
run 0 render builtin:boxes $small --output=b.exr --light-center -0.5,3,0 --light-size=0.5,0.5
run 0 render $small -oc.exr --light-center -5e-1,3,0. --light-size .5 -- builtin:boxes
cmp a.exr b.exr || fail "= and space differ"
cmp a.exr c.exr || fail "number forms differ"
run 0 render builtin:boxes $small -o d.exr
cmp -s a.exr d.exr && fail "--light-center changes nothing"

# Default names; several techniques.
default=$(sed -n 's/^#define PN_TECHNIQUE_DEFAULT "\(.*\)"$/\1/p' "$header")
[ -n "$default" ] || fail "the header names no default technique"
run 0 render builtin:boxes --size 16x12 --map 8 --frames 1
[ -s "boxes-$default.png" ] || fail "default name: $(ls)"
grep -q "^boxes-$default.png  [0-9.]* ms a frame" out || fail "the path is not printed: $(cat out)"
run 0 render builtin:copies=2 --size 16x12 --map 8 --frames 1 -t hard -t pcss:samples=2
[ -s copies=2-hard.png ] && [ -s copies=2-pcss-samples=2.png ] || fail "names of several: $(ls)"

# The scene block of a result is a set-up: the same bytes again, and further options win.
run 0 render builtin:boxes $small -o one.exr --json one.json --light sun --light-size 4,2 --fov 30 --split \
  --light-center 1,2,0.1 --fit casters
run 0 render builtin:boxes --frames 1 -t hard -o two.exr --setup one.json
cmp one.exr two.exr || fail "--setup does not bring the picture back"
run 0 render builtin:boxes --frames 1 -t hard -o three.exr --setup one.json --fov 40
cmp -s one.exr three.exr && fail "an option does not override --setup"
run 0 render builtin:boxes $small -o x.png --json -
grep -q '"schema":' out && ! grep -q 'ms a frame' out || fail "--json -: $(head -3 out)"
run 0 compare builtin:boxes --size 40x30 --frames 1 --reference-samples 1 --html -
head -1 out | grep -qi '<!doctype html' && tail -1 out | grep -q '</html>' || fail "--html -: $(head -3 out)"
# What the contract alone names is enough: no target, no up.
printf '{"light":{"type":"rectangle","center":[0,3,0],"direction":[0,-1,0],' >plain.json
printf '"u":[1,0,0],"v":[0,0,-1],"size":[1,1]}}' >>plain.json
run 0 render builtin:boxes $small -o plain.exr --setup plain.json
cmp plain.exr d.exr || fail "the contract's own light object means another light"

# What is missing stays, and a misspelt key is told.
echo '{"scene":{"size":[32,30]}}' >size.json
run 0 render builtin:boxes --map 32 --frames 1 -t hard -o size.exr --setup size.json
run 0 render builtin:boxes --map 32 --frames 1 -t hard -o same.exr --size 32x30
cmp size.exr same.exr || fail "a set-up that only holds a size"
echo '{"scene":{"ligth":{},"light":{"centre":[0,3,0]},"camera":{"fow":30}}}' >keys.json
run 0 render builtin:boxes $small -o keys.exr --setup keys.json
for hint in "'ligth'.*mean light" "'centre'.*mean center" "'fow'.*mean fov"; do
  grep -qE "^penumbra: warning: --setup keys.json: .*$hint" err || fail "no hint $hint: $(cat err)"
done

# Raw buffers beside the picture.
run 0 render builtin:boxes --size 48x36 --map 32 --frames 1 -t pcss:samples=3 -o x.png --save-dir raw
[ "$(ls raw | LC_ALL=C sort | tr '\n' ' ')" = "01-pcss-samples=3.exr mask.exr normal.exr position.exr " ] ||
  fail "buffers: $(ls raw)"

# The same command twice writes the same bytes.
run 0 render builtin:leaves $small -o l1.png
run 0 render builtin:leaves $small -o l2.png
cmp l1.png l2.png || fail "not deterministic"

# Warnings, one line each, and a picture all the same.
warned() {
  local pattern=$1
  shift
  run 0 render $small -o w.png "$@"
  grep -qE "^penumbra: warning: .*$pattern" err || fail "no warning '$pattern': $* :: $(cat err)"
  [ -s w.png ] || fail "no picture: $*"
  rm -f w.png
}
warned 'inside the model' builtin:boxes --light-center 0.02,0.8,0.01 --light-target 0.02,0,0.01
warned 'lies behind the light' builtin:boxes --light-center 0,-1,0 --light-target 0,-2,0
warned 'below the ground' builtin:boxes --light-center 0,-9,0 --light-target 0,0,0
warned 'from below the ground' builtin:boxes --light sun --light-size 1 --light-center 0,-9,0 --light-target 0,0,0
warned 'box has no extent' builtin:boxes --fit 0,0,0,0,0,0
warned 'nothing that casts is in the box' builtin:boxes --fit 90,90,90,91,91,91
warned 'sees nothing of the scene' builtin:boxes --camera-target 0,99,0
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv nan 0 0\nf 1 2 3\nf 1 3 4\nf 1 1 2\nf 1 2 5\n' >some.obj
warned 'some.obj: dropped 1 triangle with a coordinate that is not finite, 1 triangle without area' some.obj
printf 'newmtl m\nmap_d none.png\n' >hole.mtl
printf 'mtllib hole.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' >hole.obj
warned 'hole.obj: texture none.png: the file is missing' hole.obj
run 0 render builtin:room $small -o inside.png --camera-position -1.7,1,-0.6 --camera-target 0,1,0 # in the wardrobe
run 0 render builtin:boxes $small -o down.png --camera-position 0,5,0 --camera-target 0,0,0        # along its own up

# bench: a table, and JSON with a ratio to the first.
run 0 bench builtin:square --size 32x24 --map 16 --frames 2 --lights 1,2 --json bench.json
grep -qE '^hard +[0-9.]+ +1\.00 ' out || fail "bench table: $(cat out)"
grep -q 'state saving' out && grep -q 'touches no pixel' out || fail "bench costs: $(cat out)"
for key in '"ratio":' '"lights":' '"stages":' '"state_saving":' '"untouched_light":' '"scene":'; do
  grep -q "$key" bench.json || fail "bench.json has no $key"
done

# bench --hierarchies: Table 2 of the bitmask paper, for people and for machines. The stack has a full image for each of
# 9 to 12 levels, the pyramid a third more than one, the hybrid two.
run 0 bench builtin:square --size 32x24 -t hard --frames 1 --hierarchies --json hierarchies.json
grep -qE '^ +2048x2048 +hybrid +[0-9.]+ +64\.00$' out || fail "hierarchies: $(cat out)"
python3 - hierarchies.json <<'END' || fail "hierarchies.json: $(cat hierarchies.json)"
import json, sys
rows = {(r["map"], r["hierarchy"]): r for r in json.load(open(sys.argv[1]))["hierarchies"]}
assert len(rows) == 12, rows
for level, size in enumerate((256, 512, 1024, 2048), 8):
    full = 8 * size * size
    assert rows[size, "hsm"]["bytes"] == sum(8 * (size >> i) ** 2 for i in range(level + 1))
    assert rows[size, "mssm"]["bytes"] == (level + 1) * full
    assert rows[size, "hybrid"]["bytes"] == 2 * full
    assert all(rows[size, h]["build_ms"] > 0 for h in ("hsm", "mssm", "hybrid"))
END
! grep -q '"hierarchies"' bench.json || fail "hierarchies without being asked for"
finish
