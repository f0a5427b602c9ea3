#!/usr/bin/env bash
# Every wrong command line and every wrong file ends in one clear line, the contract's status, and nothing written.
. "$(dirname "$0")/common.sh"

printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n' >ok.obj
: >empty.obj
# Noise that is the same each time; one has words of a format in it, as any noise has now and then.
noise() { LC_ALL=C awk -v n="$1" 'BEGIN { s = 1; for (i = 0; i < n; i++) { s = (s * 1103515245 + 12345) % 2147483648
  printf "%c", 128 + int(s / 65536) % 127 } }'; }
noise 4096 >garbage.glb
{ noise 100; printf '\nv \nf 1\n'; noise 4000; } >words.glb
noise 300 >garbage.xyz
printf 'v 0 0 0\nv 1 0 0\nl 1 2\n' >lines.obj
printf 'v nan 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n' >nan.obj
printf 'v 1e30 0 0\nv 0 1e30 0\nv 0 1 0\nf 1 2 3\n' >far.obj
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >flat.obj
printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0' >cut.stl
{
  printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\nproperty float y\n'
  printf 'property float z\nelement face 1000000\nproperty list uchar int vertex_indices\nend_header\nabc'
} >cut.ply
printf '{"asset":{"version":"2.0"},"meshes":[' >cut.gltf
printf 'OFF\n2000000000 2000000000 0\n0 0 0\n' >huge.off
mkfifo pipe.obj

s="builtin:square --size 32x24 --map 16 --frames 1"

# files
rejected 2 'none.obj: No such file' render none.obj
rejected 2 'is a directory' render .
rejected 2 'is empty' render empty.obj
rejected 2 'not a regular file' render pipe.obj
rejected 2 'SCENE is empty' render ''
rejected 2 'garbage.glb: .*damaged, or not a .glb file' render garbage.glb
rejected 2 'words.glb: .*damaged, or not a .glb file' render words.glb
rejected 2 'garbage.xyz: ' render garbage.xyz
rejected 2 'cut.gltf: ' render cut.gltf
rejected 2 'cut.stl: ' render cut.stl
rejected 2 'cut.ply: ' render cut.ply
rejected 2 'huge.off: ' render huge.off
rejected 2 'no triangles' render lines.obj
rejected 2 'no usable triangles.*not finite' render nan.obj
rejected 2 'no usable triangles.*beyond 1e15' render far.obj
rejected 2 'no usable triangles.*without area' render flat.obj
rejected 2 'builtin:boxs: .*did you mean boxes' render builtin:boxs
rejected 2 'takes no number' render builtin:boxes=3
for n in 0 -1 x 1e3 '' 5000; do rejected 2 'from 1 to 4096' render "builtin:copies=$n"; done

# commands
rejected 2 "unknown command 'rendr'; did you mean render" rendr
rejected 2 "unknown command 'frobnicate'" frobnicate
rejected 2 'needs SCENE' render
rejected 2 'not available in this version' study
rejected 2 'not available in this version' view
rejected 2 'one argument too many' render ok.obj ok.obj
rejected 2 "unknown 'scens'; did you mean scenes" list scens
rejected 2 'not techniques, scenes or studies' list everything
rejected 2 "'pcs' .*did you mean" help pcs

# option forms
rejected 2 'unknown option --siz; did you mean --size' render ok.obj --siz 3
rejected 2 'unknown option -x' render ok.obj -x
rejected 2 '--output needs a value' render ok.obj -o
rejected 2 '--split takes no value' render ok.obj --split=yes
rejected 2 '--html is not an option of penumbra render' render ok.obj --html x.html
rejected 2 '--no-cache is not an option of penumbra render' render ok.obj --no-cache
rejected 2 '--reference-samples is not an option of penumbra bench' bench --reference-samples 4
rejected 2 'not an option of penumbra list' list --size 3x3

# values
for v in 0x3 3x0 100000x3 3x16385; do rejected 2 '--size: .*from 1 to 16384' render ok.obj --size $v; done
for v in 3 x 3x axb 3x3x3 -3x3 nan; do rejected 2 '--size: .*not WxH' render ok.obj --size $v; done
for v in 0 100000 8193 5x0; do rejected 2 '--map: .*from 1 to 8192' render ok.obj --map $v; done
for v in '' x -4 1.5; do rejected 2 '--map: .*not N' render ok.obj --map "$v"; done
for v in 0 -1 1,0 0,1; do rejected 2 '--light-size: .*greater than 0' render ok.obj --light-size $v; done
for v in nan inf x '' 1, 1,2,3 0x10 1e999; do rejected 2 '--light-size: ' render ok.obj --light-size "$v"; done
for o in --light-center --light-target --light-up --camera-position --camera-target --camera-up; do
  for v in 1,2 1,2,3,4 nan,0,0 0,inf,0 a,b,c '' 1e30,0,0; do rejected 2 "\\$o: " render ok.obj $o "$v"; done
done
for v in 0 -5 180 nan x; do rejected 2 '--fov: ' render ok.obj --fov $v; done
rejected 2 '--light: .*rectangle or sun' render ok.obj --light disk
rejected 2 '--ground: .*on or off' render ok.obj --ground maybe
rejected 2 '--up: .*y or z' render ok.obj --up x
rejected 2 '--normals: .*given or depth' render ok.obj --normals none
rejected 2 '--visibility-scale: .*1, 2 or 4' render ok.obj --visibility-scale 3
rejected 2 '--fit: ' render ok.obj --fit tight
rejected 2 '--fit: .*must not exceed' render ok.obj --fit 1,0,0,0,1,1
rejected 2 '--frames: ' render ok.obj --frames 0
rejected 2 '--lights: ' bench --lights 0
rejected 2 '--light-texture: .*not available' render ok.obj --light-texture x.png
rejected 2 "--device: 'gpu'" render ok.obj --device gpu
rejected 2 '--device 99: there is no such device' render ok.obj --device 99
rejected 2 "must end in .png or .exr" render ok.obj -o x.jpg
rejected 2 'names one file' render ok.obj -o x.png -t hard -t pcss

# techniques: read from their tables
rejected 2 "technique 'hrad' .*did you mean hard" render ok.obj -t hrad
rejected 2 'did you mean samples' render ok.obj -t pcss:sample=3
for v in '' x -5 0 nan 1e9; do rejected 2 'samples=' render ok.obj -t "pcss:samples=$v"; done
rejected 2 'filter' render ok.obj -t pcf:filter=blox

# set-ups that cannot be
rejected 2 "light-target is the light's own centre" render $s --light-target 0,3,0
rejected 2 '--light-up is zero' render $s --light-up 0,0,0
rejected 2 '--camera-up is zero' render $s --camera-up 0,0,0
rejected 2 "camera-target is the camera's own" render $s --camera-position 1,1,1 --camera-target 1,1,1
rejected 2 'at most 90 degrees' render $s --light sun --light-size 91
rejected 2 '--split: .*no ground' render builtin:terrain --split
rejected 2 '--split: .*no ground' render ok.obj --split --ground off

# --setup
rejected 2 '--setup none.json: No such file' render $s --setup none.json
mkdir folder.json
rejected 2 '--setup folder.json: is a directory' render $s --setup folder.json
rejected 2 '--setup /dev/zero: is not a regular file' render $s --setup /dev/zero
echo '{' >bad.json
rejected 2 'is not JSON' render $s --setup bad.json
echo '{"scene":{"name":"x"}}' >bad.json
rejected 2 'no set-up of a scene' render $s --setup bad.json
for m in '"center":[1,2]' '"center":[1,2,null]' '"center":[1,2,1e40]' '"size":[0,1]' '"size":"big"' '"type":"disk"'; do
  echo "{\"scene\":{\"light\":{$m}}}" >bad.json
  rejected 2 '--setup bad.json: ' render $s --setup bad.json
done

# outputs
rejected 1 'cannot write none/x.png: No such file' render $s -o none/x.png
rejected 1 'cannot write none/x.json' render $s --json none/x.json
rejected 1 'cannot make the directory none/x' render $s --save-dir none/x
rejected 1 'ok.obj: it is not a directory' render $s --save-dir ok.obj
mkdir folder.png
rejected 1 'cannot write folder.png: .*directory' render $s -o folder.png
run 1 render $s -o x.png --json /dev/full
grep -q 'cannot write /dev/full: No space' err && [ -s x.png ] || fail "full disk behind --json: $(cat err)"

# outputs that would destroy an input or one another
cp ok.obj ok.png
ln -s ok.obj model.link
ln ok.obj hard.link
ln -s new.png later.png
echo '{"scene":{"light":{"size":[1,1]}}}' >good.json
rejected 2 '--output would overwrite the model' render ok.png -o ./ok.png
rejected 2 '--json would overwrite the model' render model.link --json ok.obj
rejected 2 '--json would overwrite the model' bench ok.obj --json hard.link
rejected 2 '--html would overwrite the model' compare ok.obj --html model.link
rejected 2 '--json would overwrite the file of --setup' render $s --setup good.json --json good.json
rejected 2 '--json would overwrite --output' render $s -o new.png --json "$PWD/folder.png/../new.png"
rejected 2 '--json would overwrite --output' render $s -o new.png --json later.png
rejected 2 '--html would overwrite --output' compare $s -o new.png --html new.png
rejected 2 '--json and --html cannot both be standard output' compare $s --json - --html -
ln -s round.png about.png
ln -s about.png round.png
rejected 2 'Too many levels of symbolic links' render $s -o round.png
rejected 2 'a buffer of --save-dir would overwrite --output' render $s -o none/mask.exr --save-dir none
rejected 2 'a buffer of --save-dir would overwrite --json' compare $s --json none/reference.exr --save-dir none
rejected 2 'the picture of hard would overwrite the picture of hard' render $s -t hard -t hard
rejected 2 'the picture of hard would overwrite --json' render $s -t hard -t pcss --json square-hard.png
cmp -s ok.obj ok.png || fail "the model was touched"

# no GL device
export LIBGL_DRIVERS_PATH=/none
rejected 1 'no OpenGL 3.3 device' render $s
rejected 1 'no OpenGL 3.3 device' render $s --save-dir made # nor does the folder stay
rejected 1 'no software OpenGL 3.3' render $s --device software
export __EGL_VENDOR_LIBRARY_FILENAMES=/none
rejected 1 'no OpenGL 3.3 device' render $s
finish
