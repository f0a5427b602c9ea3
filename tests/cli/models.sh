#!/usr/bin/env bash
# What formats say that is easily lost: never silently wrong, but drawn, or left out with one line, or refused.
. "$(dirname "$0")/common.sh"
small="--size 32x24 --map 16 --frames 1 -t hard -o x.png --json x.json"

# drawn TRIANGLES LINES PATTERN ARGS...: so many triangles (the ground's two among them), so many lines on stderr.
drawn() {
  local triangles=$1 lines=$2 pattern=$3
  shift 3
  rm -f x.json
  run 0 render $small "$@"
  grep -qE "\"triangles\":[[:space:]]*$triangles," x.json || fail "not $triangles: $* :: $(grep triangles x.json)"
  [ "$(wc -l <err)" = "$lines" ] || fail "not $lines warnings: $* :: $(cat err)"
  [ "$lines" = 0 ] || grep -qE "$pattern" err || fail "no '$pattern': $* :: $(cat err)"
}

# Opacity: below one half nothing, else all, and one line.
square='v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n'
printf 'newmtl leaf\nd 0.0\nnewmtl glass\nTr 0.9\nnewmtl veil\nd 0.7\nnewmtl plain\n' >clear.mtl
printf "mtllib clear.mtl\n${square}usemtl leaf\nf 1 2 3\nusemtl plain\nf 1 3 4\n" >clear.obj
drawn 3 1 "material 'leaf' is transparent" clear.obj
printf "mtllib clear.mtl\n${square}usemtl leaf\nf 1 2 3\nusemtl glass\nf 1 3 4\nusemtl veil\nf 1 2 4\n" >clear.obj
drawn 3 1 "material 'leaf' and others are transparent: 2 meshes.*; opacity between" clear.obj
printf "mtllib clear.mtl\n${square}usemtl glass\nf 1 2 3\n" >clear.obj
rejected 2 'no usable triangles.*glass.*transparent' render clear.obj

# Names: with %20, and of libraries that are not there.
cp clear.mtl 'a b.mtl'
for name in 'a b.mtl' 'a%%20b.mtl'; do
  printf "mtllib $name\n${square}usemtl leaf\nf 1 2 3\nusemtl plain\nf 1 3 4\n" >named.obj
  drawn 3 1 "material 'leaf'" named.obj
done
printf "mtllib none.mtl\n${square}f 1 2 3\n" >missing.obj
drawn 3 1 'none.mtl: the file is missing' missing.obj

# A byte-order mark before formats that do not know one; corners counted from the end; capitals.
printf "\xef\xbb\xbf${square}f 1 2 3\nf -4 -2 -1\n" >mark.obj
drawn 4 0 '' mark.obj
printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\n' >low.stl
printf 'endloop\nendfacet\nendsolid x\n' >>low.stl
tr a-z A-Z <low.stl >capitals.stl
printf '\xef\xbb\xbf' | cat - low.stl >mark.stl
for f in low capitals mark; do drawn 3 0 '' $f.stl; done

# Strips of PLY.
{
  printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n'
  printf 'element tristrips 1\nproperty list int int vertex_indices\nend_header\n'
  printf '0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n'
} >strips.ply
rejected 2 'strips.ply: holds triangle strips' render strips.ply

# Which axis is up: the file's own word before --up, and its own units. 1 x 2 x 3 along x, y, z.
dae() {
  printf '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>'
  printf '%s</asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">' "$1"
  printf '0 0 0 1 0 0 0 2 0 0 0 3</float_array><technique_common><accessor source="#a" count="4" stride="3">'
  printf '<param name="%s" type="float"/>' X Y Z
  printf '</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
  printf '<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 1 3 0 2 3 1 2 3</p>'
  printf '</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node>'
  printf '<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>'
  printf '<instance_visual_scene url="#s"/></scene></COLLADA>'
}
# axis Z ARGS...: the standard camera looks at the middle along x, 0.38 H = 1.14 above the ground, and Z.
axis() {
  local wanted=$1
  shift
  run 0 render $small "$@" --ground off
  tr -d '\n\t ' <x.json | grep -qE "\"camera\":\{\"position\":\[[^]]*\],\"target\":\[0\.5[0-9]*,1\.14[0-9]*,$wanted" ||
    fail "not turned as it should be: $* :: $(tr -d '\n\t ' <x.json)"
}
dae '' >none.dae
dae '<up_axis>Y_UP</up_axis>' >y.dae
dae '<up_axis>Z_UP</up_axis>' >z.dae
dae '<unit name="cm" meter="0.01"/><up_axis>Y_UP</up_axis>' >cm.dae
axis 1.5 none.dae
axis -1 none.dae --up z
axis 1.5 y.dae
axis 1.5 y.dae --up z
grep -q 'says itself which axis is up' err || fail "no word about --up: $(cat err)"
axis -1 z.dae
axis -1 z.dae --up z
axis 1.5 cm.dae
fbx() {
  printf '; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}\n'
  [ -z "$1" ] || printf 'GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n%s\t}\n}\n' "$1"
  printf 'Definitions:  {\n\tVersion: 100\n\tCount: 2\n\tObjectType: "Geometry" {\n\t\tCount: 1\n\t}\n'
  printf '\tObjectType: "Model" {\n\t\tCount: 1\n\t}\n}\nObjects:  {\n\tGeometry: 1001, "Geometry::box", "Mesh" {\n'
  printf '\t\tVertices: *12 {\n\t\t\ta: 0,0,0,1,0,0,0,2,0,0,0,3\n\t\t}\n\t\tPolygonVertexIndex: *12 {\n'
  printf '\t\t\ta: 0,1,-3,0,1,-4,0,2,-4,1,2,-4\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n'
  printf '\tModel: 1002, "Model::box", "Mesh" {\n\t\tVersion: 232\n\t}\n}\nConnections:  {\n'
  printf '\tC: "OO",1002,0\n\tC: "OO",1001,1002\n}\n'
}
axes() {
  local names=(Up Front Coord) i
  for i in 0 1 2; do
    printf '\t\tP: "%sAxis", "int", "Integer", "",%s\n' "${names[i]}" "$1"
    printf '\t\tP: "%sAxisSign", "int", "Integer", "",%s\n' "${names[i]}" "$2"
    shift 2
  done
}
fbx "$(axes 2 1 1 -1 0 1)
" >z.fbx
fbx "$(axes 1 1 2 1 0 1)
" >y.fbx
fbx '' >none.fbx
axis -1 z.fbx
axis -1 z.fbx --up z
axis 1.5 y.fbx --up z
axis 1.5 none.fbx
axis -1 none.fbx --up z
finish
