# Turns .glsl files into one C file, as src/gl/embedded.h declares it.
#
#   included:  penumbra_embed_shaders(<variable> <directory> [file...]) puts the generated file's path into <variable>;
#              the files are relative to the directory, by default every .glsl file below it
#   as script: cmake -DROOT=... -DLIST=... -DOUTPUT=... -P embed_shaders.cmake does the writing, at build time
#
# The text is written as bytes, since string literals have a length limit and an escape for half of what GLSL comments
# may contain.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(embed_shaders_script "${CMAKE_CURRENT_LIST_FILE}")

  function(penumbra_embed_shaders variable root)
    set(shaders ${ARGN})
    if(NOT shaders)
      file(GLOB_RECURSE shaders CONFIGURE_DEPENDS RELATIVE "${root}" "${root}/*.glsl")
    endif()
    # The list is an input of its own: a file that was removed, or added with an old date, is noticed too.
    set(list "${CMAKE_CURRENT_BINARY_DIR}/generated/shaders.txt")
    list(JOIN shaders "\n" lines)
    file(CONFIGURE OUTPUT "${list}" CONTENT "${lines}\n" @ONLY)
    list(TRANSFORM shaders PREPEND "${root}/")
    set(output "${CMAKE_CURRENT_BINARY_DIR}/generated/embedded.c")
    add_custom_command(
      OUTPUT "${output}"
      COMMAND "${CMAKE_COMMAND}" "-DROOT=${root}" "-DLIST=${list}" "-DOUTPUT=${output}" -P "${embed_shaders_script}"
      DEPENDS ${shaders} "${list}" "${embed_shaders_script}"
      COMMENT "Embedding shaders"
      VERBATIM)
    set(${variable} "${output}" PARENT_SCOPE)
  endfunction()
  return()
endif()

file(STRINGS "${LIST}" shaders)
set(arrays "")
set(entries "")
set(count 0)
string(REPEAT "0x..," 16 sixteen)
foreach(path IN LISTS shaders)
  file(READ "${ROOT}/${path}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(${sixteen})" "\\1\n" bytes "${bytes}")
  string(APPEND arrays "static const unsigned char text_${count}[] = {\n${bytes}0};\n")
  string(APPEND entries "  {\"${path}\", (const char *)text_${count}},\n")
  math(EXPR count "${count} + 1")
endforeach()

file(WRITE "${OUTPUT}" "/* Generated from the .glsl files. */\n#include \"gl/embedded.h\"\n\n${arrays}
const pni_embedded_shader pni_embedded_shaders[] = {\n${entries}  {0, 0}};\n
const int pni_embedded_shader_count = ${count};\n")
