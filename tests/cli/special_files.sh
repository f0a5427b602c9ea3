#!/usr/bin/env bash
# Files that are none: FIFOs, links in a circle, a working directory that is gone, streams that are closed, names that
# are no text. Everything ends, in a line.
. "$(dirname "$0")/common.sh"
small="--size 32x24 --map 16 --frames 1 -t hard"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >ok.obj
mkfifo pipe.fifo pipe.png pipe.exr

# FIFOs: as model (bad_input.sh), named by a model, as set-up, as output that nobody reads.
printf 'mtllib pipe.fifo\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >mtl.obj
printf 'newmtl m\nmap_d pipe.png\n' >map.mtl
printf 'mtllib map.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n' >map.obj
cat >buffer.gltf <<'JSON'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"pipe.fifo"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}
JSON
rejected 2 'mtl.obj: refers to pipe.fifo, which is not a regular file' render mtl.obj
rejected 2 'map.obj: refers to pipe.png, which is not a regular file' render map.obj
rejected 2 'buffer.gltf: refers to pipe.fifo, which is not a regular file' render buffer.gltf
rejected 2 '--setup pipe.fifo: is not a regular file' render ok.obj --setup pipe.fifo
rejected 1 'cannot write pipe.png: nobody reads from it' render ok.obj $small -o pipe.png
rejected 1 'cannot write pipe.exr: nobody reads from it' render ok.obj $small -o pipe.exr
run 0 render ok.obj $small -o wanted.png
cat pipe.png >got.png &
run 0 render ok.obj $small -o pipe.png
wait
cmp wanted.png got.png || fail "another picture through a FIFO"

# Links in a circle.
ln -s a.obj b.obj
ln -s b.obj a.obj
rejected 2 'a.obj: Too many levels of symbolic links' render a.obj
rejected 2 'a.obj: Too many levels of symbolic links' render ok.obj --setup a.obj

# A working directory that is gone.
gone() {
  local wanted=$1 pattern=$2 status=0
  shift 2
  (mkdir gone && cd gone && rmdir ../gone && timeout 100 "$program" "$@" >"$folder/out" 2>"$folder/err") || status=$?
  [ "$status" = "$wanted" ] || fail "status $status without a directory: $* :: $(cat err)"
  [ "$(wc -l <err)" = 1 ] && grep -q "$pattern" err || fail "no line '$pattern' without a directory: $* :: $(cat err)"
}
gone 2 'No such file' render "$folder/ok.obj" $small
gone 2 'No such file' render builtin:boxes $small -o x.png
gone 2 'No such file' render builtin:boxes $small -o x.png --save-dir there/and/there
gone 2 'No such file' compare builtin:boxes $small --json deep/x.json
[ "$(ls -d gone 2>/dev/null)" = "" ] || fail "the directory is back"

# Closed streams: no file gets a stream's number and what is printed into it.
for closed in '>&-' '<&- >&-'; do
  status=0
  rm -f got.png
  eval "'$program' render ok.obj $small -o got.png --json got.json 2>err $closed" || status=$?
  [ "$status" = 1 ] && grep -q 'standard output cannot be written' err || fail "status $status with $closed: $(cat err)"
  cmp wanted.png got.png || fail "another picture with $closed"
done

# A name that is no text: JSON is.
name=$(printf 'caf\xe9')
cp ok.obj "$name.obj"
run 0 render "$name.obj" $small -o x.png --json x.json
iconv -f UTF-8 -t UTF-8 x.json >/dev/null || fail "JSON that is not UTF-8"
grep -q '"caf?"' x.json || fail "the name in JSON: $(head -c 400 x.json)"
cp ok.obj "$(printf 'caf\xc3\xa9').obj"
run 0 render "$(printf 'caf\xc3\xa9').obj" $small -o x.png --json x.json
grep -q "\"$(printf 'caf\xc3\xa9')\"" x.json || fail "a good name was changed: $(head -c 400 x.json)"
finish
