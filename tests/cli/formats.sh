#!/usr/bin/env bash
# Files of every common format load, with the triangles they have. Needs Debian's assimp-testmodels.
models=/usr/share/assimp/models
[ -d "$models" ] || exit 77
. "$(dirname "$0")/common.sh"

# loads TRIANGLES FILE: two of the triangles are the ground's.
loads() {
  run 0 render "$models/$2" --size 32x24 --map 32 --frames 1 -t hard -o x.png --json x.json
  local n
  n=$(sed -n 's/.*"triangles":[[:space:]]*\([0-9]*\).*/\1/p' x.json)
  [ "$n" = "$(($1 + 2))" ] || fail "$2: $n triangles with the ground, not $1 + 2"
}
loads 12 glTF2/BoxTextured-glTF/BoxTextured.gltf
loads 12 glTF2/BoxTextured-glTF-Binary/BoxTextured.glb
loads 12 glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf
loads 12 OBJ/box.obj
loads 12 PLY/cube.ply
loads 12 PLY/cube_binary.ply
loads 12 FBX/box.fbx
loads 12 3DS/cube_with_diffuse_texture.3DS
finish
