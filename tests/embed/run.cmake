# Embeds files with everything that a list, a string literal or a shell could trip over, and reads them back.
set(root "${WORK}/src")
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${root}/sub/deeper")
string(ASCII 195 188 226 130 172 255 1 127 bytes)
file(WRITE "${root}/characters.glsl"
     "a;b;[c;]] \\ \\\\ \\n \" ' %d %% ??/ \${X} $ENV{HOME} @X@ #include \"x\" ${bytes}\r\n\t/* \\\n */ // no end")
file(WRITE "${root}/empty.glsl" "")
string(REPEAT "float value = 1.0; // [;] 0123456789 \\\"\n" 5000 long)
file(WRITE "${root}/sub/deeper/long.glsl" "${long}")
set(paths characters.glsl empty.glsl sub/deeper/long.glsl)

list(JOIN paths "\n" lines)
file(WRITE "${WORK}/list.txt" "${lines}\n")
execute_process(COMMAND "${CMAKE_COMMAND}" "-DROOT=${root}" "-DLIST=${WORK}/list.txt" "-DOUTPUT=${WORK}/embedded.c"
                -P "${SCRIPT}"
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CC}" -std=c17 -pedantic -Wall -Wextra -Werror "-I${SOURCE}" "${MAIN}" "${WORK}/embedded.c" -o
                        "${WORK}/print" COMMAND_ERROR_IS_FATAL ANY)

execute_process(COMMAND "${WORK}/print" OUTPUT_VARIABLE names OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT names STREQUAL lines)
  message(FATAL_ERROR "embedded are:\n${names}")
endif()
foreach(path IN LISTS paths)
  execute_process(COMMAND "${WORK}/print" "${path}" OUTPUT_FILE "${WORK}/printed" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${root}/${path}" "${WORK}/printed"
                  RESULT_VARIABLE differs)
  if(differs)
    message(FATAL_ERROR "${path} came back changed: compare ${WORK}/printed")
  endif()
endforeach()
